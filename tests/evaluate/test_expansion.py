import json
import sys
from dataclasses import dataclass

import numpy as np
import pytest

from panokit.cli.main import main
from panokit.color import srgb_decode_u8
from panokit.envmap import EnvironmentMap
from panokit.errors import ModelError, UsageError
from panokit.evaluate import (
    ExpansionEvaluation,
    Method,
    evaluate_expansion,
    model_method,
    write_evaluation,
)
from panokit.evaluate.expansion_report import evaluation_markdown, evaluation_record
from panokit.io import write_environment_map
from panokit.shipped import shipped_path

QUICK = ExpansionEvaluation(folds=2, roll_probes=1)
BASELINES = ("LDR", "sRGB", "inverse Reinhard", "area rule")


@dataclass
class Peer:
    """The decoded picture, and a count of how often it was asked for."""

    digest: str = "peer"
    asked: int = 0
    seen: frozenset[str] | None = None

    def predict(self, pixels):
        self.asked += 1
        return srgb_decode_u8(pixels)

    def has_seen(self, probe):
        return None if self.seen is None else probe.sha256 in self.seen


def method(peer: Peer, name: str = "peer") -> Method:
    return Method(name=name, predictor=lambda fold: peer)


def test_every_method_is_judged_on_every_picture(probe_folder, tmp_path):
    result = evaluate_expansion(probe_folder, [method(Peer())], tmp_path, QUICK)
    assert set(result.methods) == {*BASELINES, "peer"}
    assert len(result.rows) == 5 * 8 * 2
    assert not any(row.failed for row in result.rows)
    rolled = [row for row in result.rows if "roll_37" in row.values]
    assert {(row.probe, row.camera) for row in rolled} == {("map0", "A")}
    peers = [row for row in result.rows if row.method == "peer"]
    plain = [row for row in result.rows if row.method == "sRGB"]
    for a, b in zip(peers, plain, strict=True):
        assert a.values["irradiance_mean"] == pytest.approx(b.values["irradiance_mean"], abs=1e-4)


def test_one_fold_is_judged_with_a_rule_of_the_other(probe_folder, tmp_path):
    settings = QUICK.model_copy(update={"fold": 1, "roll_probes": 0, "cameras": ("A",)})
    result = evaluate_expansion(probe_folder, [], tmp_path, settings)
    assert {row.fold for row in result.rows} == {1}
    assert len({row.probe for row in result.rows}) == 4
    assert set(result.rules) == {0, 1}
    assert len(result.rule_of_all) == 2


def test_an_interrupted_run_goes_on_and_a_new_method_costs_only_itself(probe_folder, tmp_path):
    settings = QUICK.model_copy(update={"roll_probes": 0})
    peer = Peer()

    class StopError(Exception):
        pass

    def interrupted(fold):
        if peer.asked == 6:
            raise StopError
        return peer

    with pytest.raises(StopError):
        evaluate_expansion(
            probe_folder, [Method(name="peer", predictor=interrupted)], tmp_path, settings
        )
    first = evaluate_expansion(probe_folder, [method(peer)], tmp_path, settings)
    assert peer.asked == 16
    other = Peer(digest="other")
    second = evaluate_expansion(
        probe_folder, [method(peer), method(other, "other")], tmp_path, settings
    )
    assert (peer.asked, other.asked) == (16, 16)
    assert [row for row in second.rows if row.method != "other"] == list(first.rows)


def test_what_was_seen_in_training_is_marked_and_left_out(probe_folder, tmp_path):
    settings = QUICK.model_copy(update={"roll_probes": 0, "cameras": ("A",)})
    plain = evaluate_expansion(probe_folder, [method(Peer())], tmp_path, settings)
    from panokit.evaluate.probe_set import find_probes

    every = [probe.sha256 for probe in find_probes(probe_folder)]
    half = evaluate_expansion(
        probe_folder,
        [method(Peer(seen=frozenset(every[:3])), "part"), method(Peer(seen=frozenset(every)))],
        tmp_path,
        settings,
    )
    columns = evaluation_record(half)["cameras"]["A"]
    assert (columns["part"]["status"], columns["part"]["pictures"]) == ("unseen", 5)
    assert (columns["peer"]["status"], columns["peer"]["pictures"]) == ("seen", 8)
    assert evaluation_record(plain)["cameras"]["A"]["peer"]["status"] == "unknown"
    text = evaluation_markdown(evaluation_record(half))
    assert "peer (seen)" in text
    assert "proves nothing" in text or "prove nothing" in text
    assert "different probes" in text


def test_tables_and_json_say_the_same_and_repeat(probe_folder, tmp_path):
    result = evaluate_expansion(probe_folder, [], tmp_path, QUICK)
    paths = write_evaluation(result, tmp_path)
    record = json.loads(paths[0].read_text(encoding="utf-8"))
    text = paths[1].read_text(encoding="utf-8")
    value = record["cameras"]["B"]["sRGB"]["figures"]["irradiance_median"]["value"]
    assert f"{value:.3f}" in text
    assert record["protocol"] == "panokit-expansion-1"
    assert evaluation_markdown(record) == text
    assert len(record["rows"]) == len(result.rows)
    for camera in ("A", "B"):
        assert f"## Camera {camera}" in text
    assert "| outdoor | 4 |" in text
    before = paths[0].read_bytes()
    again = write_evaluation(evaluate_expansion(probe_folder, [], tmp_path, QUICK), tmp_path)
    assert again[0].read_bytes() == before


def test_a_map_that_cannot_be_photographed_is_left_out_and_said(tmp_path):
    folder = tmp_path / "maps"
    folder.mkdir()
    lit = np.random.default_rng(0).uniform(0.2, 3, (32, 64, 3)).astype(np.float32)
    for name, radiance in (("lit", lit), ("black", np.zeros((32, 64, 3), np.float32))):
        write_environment_map(EnvironmentMap(radiance=radiance), folder / f"{name}.exr")
    result = evaluate_expansion(folder, [], tmp_path / "out", QUICK)
    assert list(result.unusable) == ["black"]
    assert {row.probe for row in result.rows} == {"lit"}
    assert "black" in evaluation_markdown(evaluation_record(result))
    (folder / "lit.exr").unlink()
    (folder / "lit.json").unlink()
    with pytest.raises(UsageError, match="could be judged"):
        evaluate_expansion(folder, [], tmp_path / "other", QUICK)


def test_headings_must_differ(probe_folder, tmp_path):
    with pytest.raises(UsageError, match="called sRGB"):
        evaluate_expansion(probe_folder, [method(Peer(), "sRGB")], tmp_path, QUICK)


def test_a_released_model_was_trained_on_every_usable_probe(probe_folder):
    from panokit.evaluate.probe_set import find_probes

    probe = find_probes(probe_folder)[0]
    released = model_method("expand-1")
    assert released.name == "expand-1"
    assert released.predictor(0).has_seen(probe) is True
    with pytest.raises(ModelError, match="no-such"):
        model_method("no-such")


def test_a_model_for_each_fold_leaves_what_its_release_carries(probe_folder, tmp_path):
    settings = QUICK.model_copy(update={"roll_probes": 0, "cameras": ("A",)})
    methods = [method(Peer(seen=frozenset()), "mine (per fold)"), method(Peer("2"), "other")]
    write_evaluation(evaluate_expansion(probe_folder, methods, tmp_path, settings), tmp_path)
    assert [path.name for path in tmp_path.glob("metrics-*")] == ["metrics-mine.json"]
    metrics = json.loads((tmp_path / "metrics-mine.json").read_text(encoding="utf-8"))
    assert metrics["model"] == "mine (per fold)"
    assert set(metrics["cameras"]["A"]) == {*BASELINES, "mine (per fold)"}
    assert len(metrics["rows"]) == 8
    assert metrics["pairs"]["A"]["sRGB"]["irradiance_mean"]["n"] == 8
    categories = metrics["cameras"]["A"]["mine (per fold)"]["categories"]
    assert set(categories) == {"indoor", "outdoor"}
    figure = categories["outdoor"]["irradiance_median"]
    assert figure["low"] <= figure["value"] <= figure["high"]


def test_methods_are_compared_picture_by_picture(probe_folder, tmp_path):
    settings = QUICK.model_copy(update={"roll_probes": 0, "cameras": ("A",)})
    result = evaluate_expansion(probe_folder, [method(Peer())], tmp_path, settings)
    text = evaluation_markdown(evaluation_record(result))
    assert "### peer against the others, picture by picture, camera A" in text
    # The peer is the decoded picture.
    assert "| sRGB | 0 of 8 | 0.000" in text.replace("-0.000", "0.000")


def test_what_a_model_for_a_fold_has_seen_counts_more_than_its_place(probe_folder, tmp_path):
    from panokit.evaluate.probe_set import find_probes

    source = shipped_path("models/expand-1/model.toml").parent
    probes = find_probes(probe_folder)
    for fold in (0, 1):
        folder = tmp_path / f"fold-{fold}"
        folder.mkdir()
        for file in (*source.glob("*.onnx"), source / "model.toml"):
            (folder / file.name).symlink_to(file)
        record = {"seen": {probes[fold].name: probes[fold].sha256}}
        (folder / "training.json").write_text(json.dumps(record), encoding="utf-8")
    per_fold = model_method(str(tmp_path / "fold-{fold}"))
    assert per_fold.predictor(0).has_seen(probes[0]) is True
    assert per_fold.predictor(1).has_seen(probes[0]) is False


def test_models_for_each_fold_are_taken_for_unseen(probe_folder, tmp_path):
    from panokit.evaluate.probe_set import find_probes

    source = shipped_path("models/expand-1/model.toml").parent
    for fold in (0, 1):
        (tmp_path / f"fold-{fold}").symlink_to(source)
    per_fold = model_method(str(tmp_path / "fold-{fold}"))
    assert per_fold.name == "expand-1 (per fold)"
    probe = find_probes(probe_folder)[0]
    assert per_fold.predictor(1).has_seen(probe) is False
    light = per_fold.predictor(1).predict(np.full((64, 128, 3), 90, np.uint8))
    assert light.shape == (64, 128, 3)


def test_folds_without_a_model_are_left_out_and_said(probe_folder, tmp_path):
    source = shipped_path("models/expand-1/model.toml").parent
    with pytest.raises(UsageError, match="for any fold"):
        model_method(str(tmp_path / "fold-{fold}"))
    (tmp_path / "fold-1").symlink_to(source)
    per_fold = model_method(str(tmp_path / "fold-{fold}"))
    settings = QUICK.model_copy(update={"roll_probes": 0, "cameras": ("A",)})
    result = evaluate_expansion(probe_folder, [per_fold], tmp_path / "out", settings)
    own = [row for row in result.rows if row.method == per_fold.name]
    assert len(own) == 4
    assert {row.fold for row in own} == {1}
    assert "different probes" in evaluation_markdown(evaluation_record(result))


def test_the_command_prints_a_table_that_fits_a_terminal(probe_folder, tmp_path, capsys):
    arguments = ["evaluate", "expansion", "--probes", str(probe_folder), "--out", str(tmp_path),
                 "--fold", "0", "--folds", "2", "--roll-probes", "0", "--limit", "2"]  # fmt: skip
    assert main(arguments) == 0
    out = capsys.readouterr().out
    assert "camera A" in out
    assert "expand-2*" in out
    assert "proves nothing" in out
    assert max(map(len, out.splitlines())) <= 80 or str(tmp_path) in out
    assert (tmp_path / "expansion.md").exists()
    assert main([*arguments, "--json"]) == 0
    value = json.loads(capsys.readouterr().out)
    assert value["cameras"]["A"]["expand-2"]["status"] == "seen"


def test_a_command_of_the_users_is_a_column(probe_folder, tmp_path, capsys):
    script = tmp_path / "twice.py"
    script.write_text(
        "import sys\nimport numpy as np\nfrom panokit.envmap import EnvironmentMap\n"
        "from panokit.io import read_panorama, write_environment_map\n"
        "pixels = read_panorama(sys.argv[1]).pixels\n"
        "light = ((pixels / 255) ** 2.2).astype(np.float32)\n"
        "write_environment_map(EnvironmentMap(radiance=light), sys.argv[2])\n",
        encoding="utf-8",
    )
    peer = f"gamma={sys.executable} {script} {{input}} {{output}}"
    arguments = ["evaluate", "expansion", "--probes", str(probe_folder), "--out", str(tmp_path),
                 "--model", "expand-1", "--peer", peer, "--roll-probes", "0", "--limit", "1",
                 "--cameras", "A"]  # fmt: skip
    assert main(arguments) == 0
    assert "gamma?" in capsys.readouterr().out
    record = json.loads((tmp_path / "expansion.json").read_text(encoding="utf-8"))
    assert record["judged"] == ["expand-1", "gamma"]
    figures = record["cameras"]["A"]["gamma"]["figures"]
    plain = record["cameras"]["A"]["sRGB"]["figures"]
    # A power of 2.2 is sRGB, nearly.
    for key in ("irradiance_median", "energy_median"):
        assert figures[key]["value"] == pytest.approx(plain[key]["value"], abs=0.05)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (["--fold", "7"], "fold must be"),
        (["--cameras", "C"], "cameras must be"),
        (["--peer", "x="], "NAME=PROGRAM"),
        (["--model", "no-such"], "no-such"),
    ],
)
def test_wrong_wishes_are_one_line(probe_folder, tmp_path, capsys, wrong, message):
    arguments = ["evaluate", "expansion", "--probes", str(probe_folder), "--out", str(tmp_path)]
    assert main([*arguments, *wrong]) in (2, 6)
    error = capsys.readouterr().err
    assert message in error
    assert len(error.strip().splitlines()) == 1


def test_a_folder_that_is_not_there_is_one_line(tmp_path, capsys):
    missing = str(tmp_path / "none")
    assert main(["evaluate", "expansion", "--probes", missing, "--out", str(tmp_path)]) == 4
    assert "none" in capsys.readouterr().err
