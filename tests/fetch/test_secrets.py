"""A fixed key is in no file, no log line and no traceback of a run, whatever happens in it."""

import logging
import traceback
from functools import partial
from urllib.parse import quote

import pytest

from panokit.cli.main import main
from panokit.errors import PanokitError
from panokit.fetch import fetch
from panokit.http import Client, Policy
from panokit.synthetic import StreetServer, parse_faults
from panokit.synthetic.faults import Faults, Trouble
from panokit.synthetic.google_static import SIGNING_SECRET
from tests.fetch.conftest import KEY, google

CALM = Faults()
ROUGH = Faults(
    troubles=[
        Trouble(kind=kind, path=path)
        for kind in ("429", "429-body", "500", "html", "truncated")
        for path in ("/panoIds", "/tiles/")
    ],
    missing_tiles=frozenset({(2, 0, 0)}),
)
REFUSED = Faults(api_disabled=True)


@pytest.mark.parametrize("faults", [CALM, ROUGH, REFUSED], ids=["calm", "rough", "refused"])
def test_the_key_is_nowhere(server, tmp_path, caplog, capfd, faults):
    caplog.set_level(logging.DEBUG)
    server.set_faults(faults)
    # The server logs whole request lines, as servers do; it is not what is tested here.
    logging.getLogger("panokit.synthetic").setLevel(logging.INFO)
    told: list[str] = []
    try:
        with Client(Policy(first_delay_s=0.01, rate_per_s=1000)) as client:
            result = fetch(
                google(server),
                tmp_path,
                client=client,
                report=lambda event: told.append(repr(event)),
            )
        told.append(repr(result))
    except PanokitError as error:
        told += traceback.format_exception(error)
    printed = capfd.readouterr()
    told += [caplog.text, printed.out, printed.err]
    files = [path for path in tmp_path.rglob("*") if path.is_file()]
    sessions = {
        request.query["session"] for request in server.requests if "session" in request.query
    }
    assert any(request.query.get("key") == KEY for request in server.requests)
    for secret in (KEY, *sessions):
        assert secret not in "".join(told)
        assert not [path for path in files if secret in str(path)]
        assert not [path for path in files if secret.encode() in path.read_bytes()]


TOKEN = "MLY|12345|the-fixed-token-of-the-tests"
OPTIONS = {
    "google-tiles": ["--accept-terms", "google", "--zoom", "1"],
    "google-static": ["--accept-terms", "google"],
    "mapillary": [],
}
ROUGH_WORDS = "429-body x1, 500 x2, html x1, truncated x1, reset x1"


@pytest.fixture
def small_server(pictures, monkeypatch):
    monkeypatch.setenv("GOOGLE_MAPS_API_KEY", KEY)
    monkeypatch.setenv("GOOGLE_MAPS_SIGNING_SECRET", SIGNING_SECRET)
    monkeypatch.setenv("MAPILLARY_TOKEN", TOKEN)
    with StreetServer(pictures[2:], key=KEY, token=TOKEN) as running:
        yield running


@pytest.mark.parametrize("source", OPTIONS)
@pytest.mark.parametrize("trouble", ["calm", "rough", "refused", "no server"])
def test_no_credential_is_in_anything_that_a_command_leaves(
    small_server, tmp_path, caplog, capfd, monkeypatch, source, trouble
):
    caplog.set_level(logging.DEBUG)
    logging.getLogger("panokit.synthetic").setLevel(logging.INFO)
    monkeypatch.setattr("panokit.fetch.stage.Policy", partial(Policy, first_delay_s=0.01))
    small_server.set_faults(parse_faults(ROUGH_WORDS if trouble == "rough" else ""))
    endpoint = "http://127.0.0.1:9" if trouble == "no server" else small_server.url
    secrets = [KEY, TOKEN, TOKEN.rpartition("|")[2], SIGNING_SECRET]
    if trouble == "refused":
        monkeypatch.setenv("GOOGLE_MAPS_API_KEY", "AIza-a-refused-key")
        monkeypatch.setenv("MAPILLARY_TOKEN", "MLY|a-refused-token")
        secrets = ["a-refused-key", "a-refused-token", SIGNING_SECRET]
    where = ["--point", "48.503", "7.7", "--radius-m", "40", "--out", str(tmp_path / "run")]
    options = ["--source", source, "--endpoint", endpoint, "--count", "1", *OPTIONS[source]]
    code = main(["fetch", *where, *options, "--json"])
    assert code == {"calm": 0, "rough": 0, "refused": 8, "no server": 7}[trouble]
    printed = capfd.readouterr()
    told = caplog.text + printed.out + printed.err
    sent = {request.query.get("signature") for request in small_server.requests} - {None}
    assert (source == "google-static" and trouble == "calm") <= bool(sent)
    for secret in (*secrets, *(quote(secret, safe="") for secret in secrets), *sent):
        assert secret not in told
        for path in tmp_path.rglob("*"):
            assert secret not in str(path)
            assert not path.is_file() or secret.encode() not in path.read_bytes(), path


def test_storage_hosts_get_no_credential(small_server, tmp_path):
    where = ["--point", "48.5025", "7.7", "--radius-m", "200", "--out", str(tmp_path / "run")]
    main(["fetch", *where, "--source", "mapillary", "--endpoint", small_server.url, "--count", "2"])
    stored = [one for one in small_server.requests if one.port == "storage"]
    assert len(stored) == 2
    assert small_server.violations == []
    assert not [one for one in stored if TOKEN in str(one.query) or KEY in str(one.query)]
