"""Fetching from a local server against a bare download of the same bytes.

pytest tests/benchmarks/test_fetch.py --benchmark-columns=min,mean,rounds

The server is another process and has every tile encoded before the clock starts. The bare
download checks nothing; "durable" writes each file and syncs it, as panokit does, "in memory"
throws the bytes away.
"""

import os
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import requests

from panokit.fetch import fetch
from panokit.io.files import write_json
from panokit.io.images import encode_jpeg
from tests.fetch.town import town, wanted

PANORAMAS, CONCURRENCY = 24, 8
KEY = {"key": "panokit"}


@pytest.fixture(scope="module")
def endpoint(tmp_path_factory):
    folder = tmp_path_factory.mktemp("served")
    # Tiles of about 40 kB, as those of streets are.
    noise = np.random.default_rng(0).normal(128, 12, (1024, 2048, 3))
    detailed = encode_jpeg(np.clip(noise, 40, 250).astype(np.uint8), quality=85)
    for picture in town(folder, PANORAMAS):
        record = picture.capture.to_json()
        write_json(folder / f"{picture.image.stem}.json", record)
        picture.image.write_bytes(detailed)
    serve = [sys.executable, "-m", "panokit", "synthetic", "serve", "--images", str(folder)]
    with subprocess.Popen(
        [*serve, "--port", "0"],
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONUNBUFFERED": "1"},
    ) as process:
        yield process.stdout.readline().split()[-1]
        process.terminate()


@pytest.fixture(scope="module")
def addresses(endpoint, tmp_path_factory):
    os.environ["GOOGLE_MAPS_API_KEY"] = "panokit"
    result = fetch(wanted(endpoint, PANORAMAS), tmp_path_factory.mktemp("warm"))
    return [
        (
            f"{endpoint}/v1/streetview/tiles/{one.grid.zoom}/{column}/{row}",
            {"panoId": one.capture.id},
        )
        for one in result.stored
        for column, row in one.grid.cells()
    ]


def bare_download(endpoint, addresses, out=None):
    local = threading.local()
    url = f"{endpoint}/v1/createSession"
    session = requests.post(url, params=KEY, json={"mapType": "streetview"}, timeout=9).json()
    signed = KEY | {"session": session["session"]}

    def get(numbered):
        number, address = numbered
        if not hasattr(local, "session"):
            local.session = requests.Session()
        url, params = address
        body = local.session.get(url, params=params | signed, timeout=9).content
        if out is not None:
            with (out / str(number)).open("wb") as file:
                file.write(body)
                file.flush()
                os.fsync(file.fileno())
        return len(body)

    with ThreadPoolExecutor(CONCURRENCY) as threads:
        return sum(threads.map(get, enumerate(addresses)))


@pytest.mark.benchmark(group="tiles of 24 panoramas")
def test_bare_download_durable(benchmark, endpoint, addresses, tmp_path):
    assert benchmark.pedantic(bare_download, args=(endpoint, addresses, tmp_path), rounds=5) > 1e6


@pytest.mark.benchmark(group="tiles of 24 panoramas")
def test_bare_download_in_memory(benchmark, endpoint, addresses):
    assert benchmark.pedantic(bare_download, args=(endpoint, addresses), rounds=5) > 1e6


@pytest.mark.benchmark(group="tiles of 24 panoramas")
def test_panokit(benchmark, endpoint, addresses, tmp_path_factory):
    def run():
        return fetch(wanted(endpoint, PANORAMAS), tmp_path_factory.mktemp("run"))

    result = benchmark.pedantic(run, rounds=5)
    assert sum(len(one.files) for one in result.stored) == len(addresses)
