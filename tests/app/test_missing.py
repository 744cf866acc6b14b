"""Without its extra the application says how to install it."""

import sys

import pytest

from panokit.app.server import build
from panokit.app.settings import AppSettings
from panokit.cli.main import main
from panokit.errors import MissingExtraError


@pytest.fixture(autouse=True)
def without_nicegui(monkeypatch):
    monkeypatch.setitem(sys.modules, "nicegui", None)


def test_the_extra_is_named():
    with pytest.raises(MissingExtraError, match=r"panokit\[app\]"):
        build(AppSettings(), 8710)


def test_the_command_ends_with_one_line(capsys):
    assert main(["app", "--no-show", "--port", "18790"]) == MissingExtraError.exit_code
    assert "panokit[app]" in capsys.readouterr().err


def test_a_port_that_cannot_be_is_refused(capsys):
    assert main(["app", "--no-show", "--port", "80"]) == 2
    assert "--port" in capsys.readouterr().err
