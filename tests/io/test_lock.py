import subprocess
import sys
import time

import pytest

from panokit.errors import UsageError
from panokit.io.lock import only_process

_HOLDER = """
import sys, time
from pathlib import Path
from panokit.io.lock import only_process
with only_process(Path(sys.argv[1]), ".lock", "rendering into"):
    print("held", flush=True)
    time.sleep(60)
"""


def test_only_one_process_and_a_killed_one_lets_go(tmp_path):
    command = [sys.executable, "-c", _HOLDER, str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as holder:
        assert holder.stdout.readline() == b"held\n"
        with (
            pytest.raises(UsageError, match=r"is rendering into .* choose another --out"),
            only_process(tmp_path, ".lock", "rendering into"),
        ):
            pytest.fail("two held it")
        holder.kill()
    deadline = time.monotonic() + 10
    while True:
        try:
            with only_process(tmp_path, ".lock", "rendering into"):
                break
        except UsageError:
            assert time.monotonic() < deadline
    assert list(tmp_path.iterdir()) == []
