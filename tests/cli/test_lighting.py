"""`panokit lighting` from the command line."""

import json

import numpy as np
import pytest

from panokit.cli.main import main
from panokit.io import read_exr
from tests.lighting.clips import frame, sideways, write_folder, write_video
from tests.lighting.fakes import write_model

pytestmark = pytest.mark.train  # the model is made with onnx


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cli-lighting")
    write_model(folder / "sum")
    write_video(folder / "ball.mp4", sideways())
    write_folder(folder / "frames", sideways(14))
    write_folder(folder / "still", [frame(200)] * 4)
    return folder


def run(place, *arguments, capsys=None, exports=True):
    code = main(
        ["lighting", *map(str, arguments), "--model", str(place / "sum")]
        + ([] if exports else ["--write.exports"])
    )
    return code, capsys.readouterr() if capsys else None


def test_a_click_in_a_video_gives_all_files(place, tmp_path, capsys):
    code, said = run(
        place, place / "ball.mp4", "--click", "200,90", "--out", tmp_path, capsys=capsys
    )
    assert code == 0
    assert "views: frames 0 and" in said.out
    assert f"The light: {tmp_path / 'light.exr'}" in said.out
    radiance, _ = read_exr(tmp_path / "light.exr")
    assert radiance.shape == (128, 256, 3)
    assert np.isfinite(radiance).all()
    assert radiance.max() > 0
    record = json.loads((tmp_path / "session.json").read_text())
    assert record["model"] == "sum"
    assert (tmp_path / "light.blender.py").is_file()
    assert (tmp_path / "views" / "1_left.png").is_file()


def test_folders_frames_and_several_clicks(place, tmp_path, capsys):
    code, said = run(
        place, place / "frames", "--click", "200,90", "--click", "196,95@2", "--out", tmp_path,
        "--json", capsys=capsys,
    )  # fmt: skip
    assert code == 0
    record = json.loads(said.out)
    assert [one["frames"]["left"] for one in record["objects"]] == [0, 2]


def test_running_goes_on_to_the_end(place, tmp_path, capsys):
    code, said = run(
        place, place / "ball.mp4", "--click", "200,90", "--running", "--out", tmp_path,
        capsys=capsys,
    )  # fmt: skip
    assert code == 0
    assert "0 changes of light, 0 frames lost" in said.out
    assert (tmp_path / "estimate.json").is_file()


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["ball.mp4"], 2, "Say where the object is"),
        (["none.mp4", "--click", "1,1"], 2, "There is no video"),
        (["ball.mp4", "--click", "here"], 2, "give column and row"),
        (["ball.mp4", "--click", "900,90"], 2, "beside the frame of 320x180"),
        (["ball.mp4", "--click", "200,90", "--frame", "99"], 2, "has 24 frames"),
        (["still", "--click", "200,90"], 3, "20% are needed"),
        (["still", "--click", "200,90", "--running"], 3, "never moved far enough"),
        (["sum/model.toml", "--click", "1,1"], 3, "is no video"),
        (["ball.mp4", "--click", "200,90", "--click", "9,9", "--running"], 2, "follows one object"),
    ],
)
def test_what_cannot_be_done_is_told_in_one_line(place, tmp_path, capsys, arguments, code, said):
    path, *more = arguments
    found, printed = run(place, place / path, *more, "--out", tmp_path / "out", capsys=capsys)
    assert found == code
    line = printed.err.strip().splitlines()[-1]
    assert line.startswith("panokit: ")
    assert said in line


def test_an_unknown_model_is_told(place, tmp_path, capsys):
    code = main(
        ["lighting", str(place / "ball.mp4"), "--click", "200,90", "--out", str(tmp_path),
         "--model", "none-1"]
    )  # fmt: skip
    assert code == 6
    assert "none-1" in capsys.readouterr().err
