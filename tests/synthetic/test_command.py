"""`panokit synthetic serve` as it is typed."""

import shlex

import pytest

import panokit.cli.synthetic
from panokit.cli.main import main


@pytest.fixture
def printed(monkeypatch, capsys, tmp_path):
    """Serves the embedded city, and runs each command that it prints meanwhile."""
    codes = {}

    def paste(_seconds):
        for line in capsys.readouterr().out.splitlines()[1:]:
            words = shlex.split(line)
            while "=" in words[0]:
                monkeypatch.setenv(*words.pop(0).split("=", 1))
            assert words[0] == "panokit"
            out = str(tmp_path / str(len(codes)))
            words[words.index("RUN")] = out
            codes[line] = main([*words[1:], "--count", "1", "--width-px", "256"])
        raise KeyboardInterrupt

    monkeypatch.setattr(panokit.cli.synthetic.time, "sleep", paste)
    assert main(["synthetic", "serve", "--port", "0", "--key", "a key"]) == 0
    return codes


def test_the_commands_it_prints_work(printed):
    assert set(printed.values()) == {0}
    assert ["google-tiles" in line for line in printed] == [False, True]


def test_a_taken_port(server, capsys):
    port = server.url.rsplit(":", 1)[1]
    assert main(["synthetic", "serve", "--port", port]) == 2
    line = capsys.readouterr().err
    assert f"Port {port} of 127.0.0.1 is in use" in line
    assert "--port 0" in line
    assert "Errno" not in line
