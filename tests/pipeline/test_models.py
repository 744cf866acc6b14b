"""From probes to models: two arms, scored on places that neither has seen."""

import json
from types import SimpleNamespace

import pytest

from panokit.dataset.settings import DatasetSettings, ObjectSettings, RigSettings
from panokit.envmap import EnvironmentMap
from panokit.errors import MissingExtraError, UsageError
from panokit.expand.settings import ExpandSettings
from panokit.io import read_environment_map, write_environment_map
from panokit.pipeline import beforehand, modelling, run_pipeline
from panokit.pipeline.references import gather_references, references_folder
from panokit.pipeline.settings import DatasetStage, EvaluateStage, ReferenceSettings
from panokit.records import RunFolder
from panokit.synthetic import CitySettings, reference_maps
from panokit.train.stereo.recipe import LightingRecipe
from tests.conftest import sun_radiance


@pytest.fixture
def chain(settings, tmp_path):
    """A pipeline to two models as small as can be, with maps of true range from a folder."""
    folder = tmp_path / "true"
    for number in range(6):
        radiance = sun_radiance(256, 15 + 9 * number, azimuth_deg=60 * number, diameter_deg=5)
        write_environment_map(EnvironmentMap(radiance=radiance), folder / f"place{number}.exr")
        (folder / f"place{number}.json").unlink()
    return settings.model_copy(
        update={
            "references": ReferenceSettings(folder=folder),
            "dataset": DatasetStage(
                count=24,
                shard_samples=24,
                settings=DatasetSettings(
                    renderer="analytic",
                    rig=RigSettings(width_px=32),
                    objects=ObjectSettings(kinds=("bowl",), per_kind=12),
                    validation_share=0.2,
                    test_share=0.3,
                    light={"own_right": "made for this test"},
                ),
            ),
            "train": LightingRecipe(
                id="least",
                network={"input_px": 32, "width": 4},
                schedule={"epochs": 1, "batch": 4},
            ),
            "evaluate": EvaluateStage(),
        }
    )


def fresh(result):
    return {batch.stage: batch.fresh for batch in result.batches}


@pytest.mark.train
def test_the_chain_ends_with_scores_and_runs_again_what_changed(chain, console):
    first = run_pipeline(chain, console)
    assert fresh(first) | {"references": 0} == {
        "fetch": 3, "stitch": 3, "inpaint": 3, "expand": 3, "qa": 3, "probes": 3,
        "references": 0, "dataset": 2, "train": 2, "evaluate": 1,
    }  # fmt: skip
    scores = first.batches[-1].receipts[0].values
    assert set(scores["scores"]) == {"references", "augmented", "mean map", "ambient color"}
    assert scores["comparisons"][0]["verdict"] == "too few places"
    of = {r.item: r.values for r in first.batches[-3].receipts}
    assert sum(of["augmented"]["lights"].values()) == sum(of["references"]["lights"].values()) + 3
    assert of["augmented"]["lights"]["test"] >= of["references"]["lights"]["test"]
    page = (first.run.root / "report.html").read_text(encoding="utf-8")
    assert "Models on held-out places" in page
    assert run_pipeline(chain, console).nothing_to_do

    recipe = chain.train.model_copy(update={"seed": 1})
    again = fresh(run_pipeline(chain.model_copy(update={"train": recipe}), console))
    assert (again["expand"], again["dataset"], again["train"], again["evaluate"]) == (0, 0, 2, 1)

    # The arm of the references is not lit by what expand makes.
    other = chain.model_copy(update={"expand": ExpandSettings(model="srgb", width_px=128)})
    result = run_pipeline(other, console)
    made = {receipt.item for receipt in result.batches[-3].receipts if receipt.fresh}
    assert made == {"augmented"}
    assert fresh(result)["train"] == 1


def test_what_one_arm_holds_out_the_other_may_not_learn_from(chain):
    """If splits ever disagreed, the run would stop before it rendered."""

    lights = {"train": ("place0", "place1"), "validation": (), "test": ()}
    maker = SimpleNamespace(stock=SimpleNamespace(lights_of=lights))
    with pytest.raises(UsageError, match="held out for the test"):
        modelling._check_held_out(chain.dataset, chain.references.folder, maker)


def test_extras_are_missed_before_anything_is_fetched(chain, console, monkeypatch):
    monkeypatch.setattr(beforehand, "find_spec", lambda name: None if name == "torch" else True)
    with pytest.raises(MissingExtraError, match=r"panokit\[train\]"):
        run_pipeline(chain, console)
    assert not chain.folder().exists()
    # What comes before needs none of them.
    result = run_pipeline(chain, console, stop_after="stitch")
    assert len(result.batches) == 2


def test_maps_of_true_range_come_from_the_folder_then_the_variable(
    chain, console, monkeypatch, tmp_path
):
    monkeypatch.delenv("PANOKIT_DATA", raising=False)
    assert references_folder(ReferenceSettings()) is None
    monkeypatch.setenv("PANOKIT_DATA", str(tmp_path))
    assert references_folder(ReferenceSettings()) == tmp_path / "probes"
    assert references_folder(chain.references) == chain.references.folder

    run = RunFolder(tmp_path / "run").create()
    before = gather_references(chain, run, console).receipts[0]
    assert gather_references(chain, run, console).receipts[0].key == before.key
    write_environment_map(
        EnvironmentMap(radiance=sun_radiance(64, 5)), chain.references.folder / "place0.exr"
    )
    assert gather_references(chain, run, console).receipts[0].key != before.key
    empty = chain.model_copy(update={"references": ReferenceSettings(folder=tmp_path / "none")})
    with pytest.raises(UsageError, match="no folder"):
        gather_references(empty, run, console)


@pytest.mark.render
def test_skies_have_suns_ground_and_no_place_on_the_map(tmp_path):
    city = CitySettings(truth_width_px=64)
    files = reference_maps(city, 0, 3, tmp_path)
    assert [path.name for path in files] == [
        "sky-clear-1-000.exr", "sky-cloudy-1-001.exr", "sky-overcast-1-002.exr",
    ]  # fmt: skip
    clear, _, overcast = (read_environment_map(path) for path in files)
    assert clear.radiance.max() > 1000 * clear.radiance.mean()
    assert overcast.radiance.max() < 10 * overcast.radiance.mean()
    assert clear.capture.latitude_deg is None
    assert clear.capture.place == "sky-clear-1-000"
    ground = overcast.radiance[20:]
    assert ground.std(axis=(0, 1)).max() < 0.01 * ground.mean()
    stamp = files[0].stat().st_mtime_ns
    reference_maps(city, 0, 3, tmp_path)
    assert files[0].stat().st_mtime_ns == stamp
    record = json.loads(files[0].with_suffix(".json").read_text())
    assert record["provenance"][0]["stage"] == "synthetic"
