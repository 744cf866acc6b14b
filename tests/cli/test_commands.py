"""The command line as a user meets it: exit codes, one-line errors, results."""

import json

import cv2
import numpy as np
import pytest

from panokit.cli.main import main
from panokit.io import read_environment_map, write_environment_map
from panokit.io.images import encode_jpeg, encode_png


@pytest.fixture
def folder(tmp_path):
    rng = np.random.default_rng(0)
    pixels = rng.integers(0, 255, (64, 128, 3), dtype=np.uint8)
    good = encode_jpeg(pixels)
    files = {
        "good.jpg": good,
        "grey.png": encode_png(pixels[..., 0]),
        "deep.png": bytes(cv2.imencode(".png", pixels.astype(np.uint16))[1]),
        "alpha.png": bytes(cv2.imencode(".png", np.dstack([pixels, pixels[..., :1]]))[1]),
        "one.png": encode_png(pixels[:1, :1]),
        "wide.png": encode_png(np.hstack([pixels, pixels[:, :64]])),
        "cut.jpg": good[: len(good) // 2],
        "text.jpg": b"hello",
    }
    source = tmp_path / "in"
    source.mkdir()
    for name, data in files.items():
        (source / name).write_bytes(data)
    return source


def errors(capsys) -> list[str]:
    return capsys.readouterr().err.strip().splitlines()


def test_bad_pictures_are_named_and_the_good_one_is_done(folder, tmp_path, capsys):
    out = tmp_path / "out"
    code = main(["expand", str(folder), "--out", str(out), "--model", "srgb"])
    captured = capsys.readouterr()
    assert code == 1
    assert "1 done, 7 rejected" in captured.out
    assert read_environment_map(out / "good.exr").width_px == 128
    lines = [line for line in captured.err.splitlines() if " rejected (" in line]
    reasons = {line.split(" ")[1]: line.split("(")[1].split(")")[0] for line in lines}
    assert reasons == {
        "alpha": "alpha",
        "cut": "truncated",
        "deep": "not-8-bit",
        "grey": "grey",
        "one": "not-equirectangular",
        "text": "not-an-image",
        "wide": "not-equirectangular",
    }


@pytest.mark.parametrize(
    ("arguments", "code", "text"),
    [
        (["expnd"], 2, 'Did you mean "expand"?'),
        (["expand", "x.jpg", "--widht-px", "3"], 2, "Did you mean --width-px?"),
        (["expand", "x.jpg", "--width-px", "3"], 2, "--width-px 3: input should be a multiple"),
        (["expand", "nowhere", "--out", "o"], 4, "There is no nowhere"),
        (["expand", "."], 2, "--out DIR"),
        (["expand", "{good}", "--out", "o", "--model", "sgrb"], 6, "Did you mean 'srgb'?"),
        (["inpaint", "{good}", "--out", "o", "--nadir-deg", "99"], 2, "--nadir-deg 99: input"),
        (
            ["expand", "{good}", "--out", "o", "--model", "gpt"],
            6,
            "Choose from: expand-1, expand-2, srgb",
        ),
        (["expand", "{good}", "--out", "o", "--workers", "0"], 2, "for --workers. Must be >= 1"),
        (["qa", "nowhere", "--out", "o"], 2, "nowhere"),
        (["run", "nowhere.toml"], 4, "Check the path"),
        (["probes", "list", "nowhere"], 2, "no probe library in nowhere"),
        (["fetch", "--out", "o"], 2, "Say where to look"),
        (["fetch", "--out", "o", "--cities", "Strassburgg"], 2, "Strasbourg"),
        (["fetch", "--out", "o", "--cities", "Lyon", "--source", "google-tiles"], 10, "google"),
    ],
)
def test_errors_are_one_line_with_a_remedy(
    arguments, code, text, folder, tmp_path, capsys, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    filled = [argument.format(good=folder / "good.jpg") for argument in arguments]
    assert main(filled) == code
    lines = errors(capsys)
    assert len(lines) == 1
    assert lines[0].startswith("panokit: ")
    assert text in lines[0]


def test_an_unknown_key_in_a_pipeline_names_the_nearest(tmp_path, capsys):
    path = tmp_path / "p.toml"
    path.write_text('name = "x"\n[fetch]\ncitys = ["Lyon"]\n')
    assert main(["run", str(path)]) == 2
    assert "line 3: there is no setting 'fetch.citys'. Did you mean 'cities'?" in errors(capsys)[0]


def test_maps_that_are_not_physical_are_rejected_by_qa(tmp_path, sunny, capsys):
    import OpenEXR

    maps = tmp_path / "maps"
    write_environment_map(sunny, maps / "good.exr")
    broken = sunny.radiance.copy()
    broken[3, 3] = np.nan
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, {"RGB": broken}) as file:
        file.write(str(maps / "broken.exr"))
    assert main(["qa", str(maps), "--out", str(tmp_path / "qa"), "--json"]) == 1
    result = json.loads(capsys.readouterr().out)
    assert result["counts"]["unreadable"] == 1
    page = (tmp_path / "qa" / "report.html").read_text(encoding="utf-8")
    assert "3 nan" in page


def test_a_library_from_the_command_line(tmp_path, sunny, capsys):
    library = str(tmp_path / "library")
    write_environment_map(sunny, tmp_path / "maps" / "sunny.exr")
    assert main(["probes", "add", library, str(tmp_path / "maps")]) == 0
    assert "sunny  added" in capsys.readouterr().out
    assert main(["probes", "add", library, str(tmp_path / "maps")]) == 0
    assert "there already" in capsys.readouterr().out
    assert main(["probes", "list", library, "--json"]) == 0
    (entry,) = json.loads(capsys.readouterr().out)
    assert main(["probes", "list", library]) == 0
    assert max(map(len, capsys.readouterr().out.splitlines())) <= 80
    assert main(["probes", "show", library, entry["id"][:6]]) == 0
    assert "256x128" in capsys.readouterr().out
    assert main(["probes", "verify", library]) == 0
    assert main(["probes", "reindex", library]) == 0
    file = next((tmp_path / "library").rglob("probe.exr"))
    file.write_bytes(file.read_bytes()[:-1] + b"x")
    capsys.readouterr()
    assert main(["probes", "verify", library]) == 1
    assert "1 damaged" in capsys.readouterr().out


def test_released_models_are_what_was_released(capsys):
    assert main(["models", "verify"]) == 0
    assert "expand-1" in capsys.readouterr().out
    assert main(["models", "show", "expand-1"]) == 0
    assert "CC0" in capsys.readouterr().out


def test_an_interruption_says_that_nothing_is_lost(monkeypatch, capsys):
    def interrupted(**_):
        raise KeyboardInterrupt

    monkeypatch.setattr("panokit.cli.doctor.doctor", interrupted)
    assert main(["doctor"]) == 130
    assert "what was done is kept" in errors(capsys)[0]


def test_a_folder_that_may_not_be_read_is_one_line(monkeypatch, capsys, tmp_path):
    def locked(_):
        raise PermissionError(13, "Permission denied", "locked/run.json")

    monkeypatch.setattr("panokit.records.RunFolder.is_run", property(locked))
    assert main(["expand", str(tmp_path), "--out", str(tmp_path / "o")]) == 4
    (line,) = errors(capsys)
    assert "locked/run.json: Permission denied. Check the permissions" in line


def test_an_unfinished_run_says_what_comes_first(tmp_path, capsys):
    (tmp_path / "run" / "captures").mkdir(parents=True)
    assert main(["expand", str(tmp_path / "run")]) == 2
    assert "Run `panokit stitch" in errors(capsys)[0]
    (tmp_path / "empty").mkdir()
    assert main(["expand", str(tmp_path / "empty"), "--out", str(tmp_path / "o")]) == 2
    assert "There are no JPEG" in errors(capsys)[0]


def test_help_fits_a_terminal(capsys):
    assert main(["--help"]) == 0
    output = capsys.readouterr().out
    assert "demo" in output
    assert max(len(line) for line in output.splitlines()) <= 80


def test_doctor_finds_the_main_job_working(capsys):
    assert main(["doctor", "--json"]) == 0
    findings = {one["name"]: one["state"] for one in json.loads(capsys.readouterr().out)}
    assert {"packages", "opencv", "exr", "model"} <= findings.keys()
    assert "broken" not in findings.values()
