import hashlib

import pytest

from panokit.io import exr
from panokit.synthetic import Faults


def test_assets_are_listed_and_described(server, http):
    listed = http.get(f"{server.url}/assets", params={"t": "hdris"}, timeout=5).json()
    assert set(listed) == {"here", "north", "far"}
    assert listed["here"]["coords"] == [44.5, -28.0]
    assert http.get(f"{server.url}/assets", params={"t": "models"}, timeout=5).json() == {}
    assert http.get(f"{server.url}/info/here", timeout=5).json() == listed["here"]
    assert http.get(f"{server.url}/info/nothing", timeout=5).status_code == 404
    server.set_faults(Faults(retired=frozenset({"here"})))
    assert http.get(f"{server.url}/files/here", timeout=5).status_code == 404


@pytest.mark.parametrize("suffix", ["exr", "hdr"])
def test_files_are_those_that_are_promised(server, http, tmp_path, suffix):
    files = http.get(f"{server.url}/files/far", timeout=20).json()["hdri"]
    assert set(files) == {"1k", "2k"}
    entry = files["1k"][suffix]
    body = http.get(entry["url"], timeout=5).content
    assert entry["url"].startswith(server.storage_url)
    assert (len(body), hashlib.md5(body).hexdigest()) == (entry["size"], entry["md5"])
    if suffix == "exr":
        (tmp_path / "map.exr").write_bytes(body)
        radiance, _ = exr.read_exr(tmp_path / "map.exr")
        assert radiance.shape == (512, 1024, 3)
        assert radiance.max() > 5
