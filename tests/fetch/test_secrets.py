"""A fixed key is in no file, no log line and no traceback of a run, whatever happens in it."""

import logging
import traceback

import pytest

from panokit.errors import PanokitError
from panokit.fetch import fetch
from panokit.http import Client, Policy
from panokit.synthetic.faults import Faults, Trouble
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
