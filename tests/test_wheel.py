"""A wheel has all that an installed user needs, and nothing that would clutter their imports."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
MOST_BYTES = 25e6


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    out = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(out)]
    subprocess.run(build, cwd=ROOT, check=True, capture_output=True)
    return next(out.glob("*.whl"))


def test_the_wheel_carries_models_pipelines_and_the_sample_city(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    assert {name.split("/")[0].split("-")[0] for name in names} == {"panokit"}
    for needed in (
        "panokit/_shipped/pipelines/demo.toml",
        "panokit/_shipped/models/expand-2/model.toml",
        "panokit/_shipped/models/expand-2/expansion.onnx",
        "panokit/_shipped/models/lighting-1/lighting.onnx",
        "panokit/lighting/clip/square.mp4",
        "panokit/synthetic/sample_city/index.json",
        "panokit/fetch/cities.csv",
        "panokit/py.typed",
    ):
        assert needed in names
    # One model for each task travels; the others stay in the repository.
    assert not any("expand-1" in name for name in names)
    assert any(name.endswith(".j2") for name in names)
    assert wheel.stat().st_size < MOST_BYTES


def test_shipped_data_is_found_in_an_installed_wheel(wheel, tmp_path):
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(tmp_path)
    code = (
        "import panokit; from panokit.weights import find_model, verify_model;"
        "from panokit.shipped import shipped_path;"
        "[verify_model(find_model(i)) for i in ('expand-2', 'lighting-1')];"
        "print(panokit.__file__, shipped_path('pipelines/demo.toml'))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, check=True, capture_output=True, text=True
    )
    assert done.stdout.count(str(tmp_path)) == 2
