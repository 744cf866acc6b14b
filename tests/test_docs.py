"""What the documentation shows works: every command line parses, every Python example runs."""

import doctest
import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from panokit.cli.main import build_app
from panokit.dataset import ProductionSettings, render_dataset
from panokit.io import write_bytes, write_environment_map, write_panorama
from panokit.io.captures import StoredCapture, write_capture
from panokit.io.files import sha256_of_bytes
from panokit.io.images import encode_jpeg
from tests.dataset.fake import FakeMaker

ROOT = Path(__file__).parent.parent
PAGES = [
    ROOT / "README.md",
    *sorted((ROOT / "docs").rglob("*.md")),
    *ROOT.glob("models/*/README.md"),
]
COMMAND = re.compile(r"^(?:    |\$ )?(panokit [a-z][^\n]*?)\s*(?:#.*)?$", re.MULTILINE)
# The network, and hours of training: their names must exist, the rest is tested elsewhere.
IMPORTS_ONLY = {"fetch.md", "train.md"}
EXAMPLE = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)


def command_lines() -> list[tuple[str, str]]:
    found = []
    for page in PAGES:
        text = page.read_text(encoding="utf-8").replace("\\\n", " ")
        blocks = re.findall(r"(?:^    .*\n|^```(?:sh|bash|console)?\n(?:.*\n)*?```)", text, re.M)
        for block in blocks:
            found += [(page.name, line) for line in COMMAND.findall(block)]
    return sorted(set(found))


def examples() -> list[tuple[str, str]]:
    return [
        (page.name, code)
        for page in PAGES
        for code in EXAMPLE.findall(page.read_text(encoding="utf-8"))
    ]


def test_there_are_commands_and_examples():
    assert len(command_lines()) > 20
    assert len(examples()) >= 2


def test_the_index_leads_to_every_page():
    docs = ROOT / "docs"
    blocks = re.findall(r"^```{toctree}\n(.*?)^```", (docs / "index.md").read_text(), re.M | re.S)
    patterns = [line for block in blocks for line in block.splitlines() if re.match(r"[a-z]", line)]
    listed = {pattern: set(docs.glob(f"{pattern}.md")) for pattern in patterns}
    assert [pattern for pattern, pages in listed.items() if not pages] == []
    assert set().union(*listed.values()) == set(docs.rglob("*.md")) - {docs / "index.md"}


LINK = re.compile(r"\]\(([^)#:\s]+)(?:#[^)]*)?\)")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_link_to_a_file_leads_somewhere(page):
    wanted = sorted(set(LINK.findall(page.read_text(encoding="utf-8"))))
    assert [link for link in wanted if not (page.parent / link).exists()] == []


@pytest.mark.parametrize(("page", "line"), command_lines())
def test_every_command_line_parses(page, line):
    tokens = shlex.split(re.sub(r"\[[^\]]*\]|\s+\|.*", "", line))[1:]
    build_app().parse_args(tokens, exit_on_error=False, print_error=True)


@pytest.fixture(scope="session")
def stereo(tmp_path_factory):
    """A tiny stereo dataset."""
    out = tmp_path_factory.mktemp("docs") / "stereo-10k"
    render_dataset(FakeMaker(), out, ProductionSettings(count=40, workers=0))
    return out


@pytest.fixture
def workspace(tmp_path, monkeypatch, street, sunny, capture, stereo):
    """The files that the examples speak of."""
    large = street.pixels.repeat(4, axis=0).repeat(4, axis=1)
    panorama = street.with_changes(pixels=np.ascontiguousarray(large))
    for name in ("street.jpg", "photo.jpg"):
        write_panorama(panorama, tmp_path / name)
    for name in ("probe.exr", "probes/probe.exr", "hdris/probe.exr"):
        write_environment_map(sunny, tmp_path / name)
    folder = tmp_path / "runs/bristol/captures/panoramax-4f1c"
    data = encode_jpeg(panorama.pixels)
    write_bytes(folder / "image.jpg", data)
    files = {"image.jpg": sha256_of_bytes(data)}
    write_capture(StoredCapture(folder=folder, capture=capture, files=files))
    (tmp_path / "stereo-10k").symlink_to(stereo)
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(("page", "code"), examples(), ids=[page for page, _ in examples()])
@pytest.mark.usefixtures("workspace")
def test_every_python_example_runs(page, code):
    if page in IMPORTS_ONLY:
        code = "\n".join(line for line in code.splitlines() if "import " in line)
    exec(compile(code, page, "exec"), {"__name__": "example"})


TAUGHT = [page for page in PAGES if ">>> " in page.read_text(encoding="utf-8")]


@pytest.mark.parametrize("page", TAUGHT, ids=[page.name for page in TAUGHT])
@pytest.mark.usefixtures("workspace")
def test_every_shown_result_is_what_comes_out(page):
    text = page.read_text(encoding="utf-8")
    example = doctest.DocTestParser().get_doctest(text, {}, page.name, str(page), 0)
    told = []
    outcome = doctest.DocTestRunner(verbose=False).run(example, out=told.append)
    assert outcome.attempted > 3
    assert outcome.failed == 0, "".join(told)
