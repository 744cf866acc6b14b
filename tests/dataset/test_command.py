"""`panokit dataset` as a user meets it, with the renderer of formulas."""

import json

import pytest

from panokit.cli.dataset import _settled
from panokit.cli.main import main
from panokit.dataset.production.settings import ProductionSettings
from panokit.dataset.settings import DatasetSettings
from panokit.dataset.storage.read import StereoDataset
from panokit.shipped import shipped_path

SMALL = (
    "--samples", "4", "--rig.width-px", "32", "--objects.per-kind", "3",
    "--objects.kinds", "chair", "--objects.kinds", "vase",
    "--validation-share", "0.2", "--test-share", "0.2",
)  # fmt: skip


def typed(library, out, *more, count="12", renderer="analytic"):
    wanted = ("--count", count, "--workers", "0") if count else ()
    more = ("--renderer", renderer, *more)
    return [
        "dataset",
        "render",
        "--probes",
        str(library),
        "--out",
        str(out),
        *wanted,
        *SMALL,
        *more,
    ]


@pytest.fixture(scope="module")
def rendered(library, tmp_path_factory):
    out = tmp_path_factory.mktemp("rendered") / "stereo"
    assert main(typed(library, out)) == 0
    return out


def test_rendering_verifying_and_looking(library, rendered, tmp_path, capsys):
    assert main(["dataset", "verify", str(rendered)]) == 0
    assert "12 samples in 3 shards: all is well" in capsys.readouterr().out
    sheet = tmp_path / "sheet.png"
    assert main(["dataset", "preview", str(rendered), "--out", str(sheet), "--count", "3"]) == 0
    assert "3 of 12 samples" in capsys.readouterr().out
    assert sheet.read_bytes().startswith(b"\x89PNG")
    assert main(typed(library, rendered)) == 0
    output = capsys.readouterr().out
    assert "12 samples" in output
    assert "nothing to do" in output


def test_what_is_printed_fits_the_terminal(library, tmp_path, capsys):
    assert main(typed(library, tmp_path / "s", "--dry-run")) == 0
    assert main(typed(library, tmp_path / "s")) == 0
    assert main(["dataset", "verify", str(tmp_path / "s")]) == 0
    captured = capsys.readouterr()
    lines = (captured.out + captured.err).replace(str(tmp_path), "stereo").splitlines()
    assert max(map(len, lines)) <= 80


def test_one_sample_again_is_the_same(library, rendered, tmp_path, capsys):
    assert main(typed(library, rendered, "--index", "5")) == 0
    told = capsys.readouterr().out
    assert "The same bytes as in " in told
    files = {path.name: path.read_bytes() for path in (rendered / "000000005").iterdir()}
    dataset = StereoDataset(rendered)
    number = dataset.number_of("000000005")
    assert files == {name: dataset.read(number, name) for name in dataset.names(number)}
    # Without the dataset, too.
    assert main(typed(library, tmp_path / "alone", "--index", "5", count="")) == 0
    alone = {path.name: path.read_bytes() for path in (tmp_path / "alone/000000005").iterdir()}
    assert alone == files


def test_a_sample_that_differs_is_named(library, rendered, tmp_path, capsys, monkeypatch):
    from panokit.dataset.production import repeat

    plain = repeat._known

    def altered(*args):
        files, shard, attempt = plain(*args)
        return {**files, "left.png": b"other"}, shard, attempt

    monkeypatch.setattr(repeat, "_known", altered)
    assert main(typed(library, rendered, "--index", "3", "--json")) == 1
    assert json.loads(capsys.readouterr().out)["different"] == ["left.png"]


def test_a_dry_run_says_how_much_and_writes_nothing(library, tmp_path, capsys):
    assert main(typed(library, tmp_path / "s", "--dry-run", "--json", count="1000")) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["splits"] == {"train": 599, "validation": 201, "test": 200}
    assert found["bytes"] > 1e6
    assert not (tmp_path / "s").exists()


def test_settings_from_a_file_with_what_is_typed_in_their_place(library, tmp_path, capsys):
    path = tmp_path / "small.toml"
    path.write_text(
        'count = 8\nworkers = 0\nrenderer = "analytic"\nsamples = 4\nseed = 5\n'
        "validation_share = 0.2\ntest_share = 0.2\n"
        '[objects]\nkinds = ["chair"]\nper_kind = 4\n[rig]\nwidth_px = 48\nfov_deg = 50\n'
    )
    out = tmp_path / "s"
    command = ["dataset", "render", "--probes", str(library), "--out", str(out)]
    assert main([*command, "--settings", str(path), "--rig.width-px", "32", "--seed", "6"]) == 0
    made = json.loads((out / "dataset.json").read_text())
    settings = DatasetSettings.model_validate(made["maker"]["settings"])
    assert made["count"] == 8
    assert (settings.rig.width_px, settings.rig.fov_deg) == (32, 50)
    assert (settings.seed, settings.objects.kinds) == (6, ("chair",))
    capsys.readouterr()
    path.write_text("[rig]\nwidht_px = 3\n")
    assert main([*command, "--settings", str(path)]) == 2
    assert "line 2: there is no setting 'rig.widht_px'. Did you mean 'width_px'?" in (
        capsys.readouterr().err
    )


@pytest.mark.parametrize(
    "path", sorted(shipped_path("pipelines/datasets").glob("*.toml")), ids=lambda path: path.name
)
def test_the_recipes_that_are_shipped_load(path):
    production, settings = _settled(path, ProductionSettings(), DatasetSettings())
    assert production.count >= 10_000
    assert settings.validation_share > 0
    typed, _ = _settled(path, ProductionSettings(count=5), DatasetSettings())
    assert (typed.count, typed.shard_samples) == (5, production.shard_samples)


@pytest.mark.parametrize(
    ("arguments", "code", "text"),
    [
        (["render", "--probes", "{lib}", "--out", "s"], 2, "Give --count N"),
        (["render", "--probes", "nowhere", "--out", "s", "--count", "3"], 2, "no folder nowhere"),
        (["render", "--probes", "{empty}", "--out", "s", "--count", "3"], 2, "no light in"),
        (["render", "--probes", "{lib}", "--out", "s", "--count", "0"], 2, "--count 0: "),
        (["render", "--probes", "{lib}", "--out", "s", "--count", "3", "--rig.width-px", "3"], 2,
         "--rig.width-px 3: input"),
        (["preview", "nowhere"], 4, "no samples in nowhere"),
        (["preview", "{done}", "--out", "sheet.gif"], 2, ".png or .jpg"),
        (["preview", "{done}", "--split", "all"], 2, "choose from train"),
        (["verify", "nowhere"], 4, "no dataset in nowhere"),
    ],
)  # fmt: skip
def test_errors_are_one_line_with_a_remedy(
    arguments, code, text, library, rendered, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    places = {"lib": library, "empty": tmp_path / "empty", "done": rendered}
    filled = [argument.format(**places) for argument in arguments]
    if filled[0] == "render":
        filled += ["--renderer", "analytic"]
    assert main(["dataset", *filled]) == code
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    assert text in lines[0]


def test_a_damaged_dataset_is_told(library, rendered, tmp_path, capsys):
    import shutil

    copy = shutil.copytree(rendered, tmp_path / "copy")
    shard = copy / "shards" / "train-00000.tar"
    shard.write_bytes(shard.read_bytes()[:-2000])
    assert main(["dataset", "verify", str(copy)]) == 1
    told = capsys.readouterr().out
    assert "train-00000.tar (digest)" in told
    assert "problems" in told


@pytest.mark.render
def test_mitsuba_makes_the_same_sample_alone_and_among_others(library, tmp_path, capsys):
    out = tmp_path / "s"
    command = typed(library, out, count="4", renderer="mitsuba")
    assert main(command) == 0
    for index in ("0", "3"):
        assert main([*command, "--index", index]) == 0
        assert "The same bytes as in " in capsys.readouterr().out
