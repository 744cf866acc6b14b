"""The house stands as the design says: imports, sizes, names, public surface."""

import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import panokit

PACKAGE = Path(panokit.__file__).parent
ROOT = PACKAGE.parent
MODULES = sorted(PACKAGE.rglob("*.py"))
HEAVY = ("numpy", "cv2", "torch", "onnxruntime", "mitsuba", "matplotlib", "distributed", "colour")


@pytest.mark.parametrize(
    "code",
    [
        "import panokit",
        "from panokit.cli.main import main; main(['--help'])",
        "from panokit.cli.main import main; main(['expand', '--help'])",
        "from panokit.cli.main import main; main(['fetch', '--help'])",
        "from panokit.cli.main import main; main(['dataset', 'render', '--help'])",
        "import panokit.pipeline.settings",
    ],
)
def test_importing_and_help_load_nothing_heavy(code):
    check = f"{code}\nimport sys\nprint([m for m in {HEAVY!r} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", check], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_every_lazy_name_is_there():
    packages = ["panokit"] + [
        f"panokit.{path.parent.name}"
        for path in PACKAGE.glob("*/__init__.py")
        if "lazy_names" in path.read_text(encoding="utf-8")
    ]
    assert len(packages) > 5
    for name in packages:
        package = import_module(name)
        assert package.__all__ == sorted(package.__all__)
        for public in package.__all__:
            if not name.endswith(("networks", "train")):
                assert getattr(package, public) is not None
        with pytest.raises(AttributeError, match="no attribute 'nothing'"):
            package.nothing  # noqa: B018


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_files_are_of_one_idea(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 350
    assert path.stem not in {"utils", "helpers", "common", "misc", "base"}
    assert lines[0].startswith('"""')


def test_data_folders_hold_no_code_and_no_names_to_import():
    for folder in ("models", "pipelines"):
        assert not list((ROOT / folder).rglob("*.py"))
    code = "import models"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, cwd="/", check=False)
    assert done.returncode != 0


def test_no_module_speaks_of_what_is_not_done():
    unfinished = re.compile(r"\b(TODO|FIXME|XXX|NotImplementedError)\b")
    for path in MODULES:
        assert not unfinished.search(path.read_text(encoding="utf-8")), path


def test_every_command_has_a_page():
    from panokit.cli.main import _COMMANDS, _GROUPS

    pages = {path.stem for path in (ROOT / "docs" / "commands").glob("*.md")}
    assert {*_COMMANDS, *_GROUPS} <= pages
