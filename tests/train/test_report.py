import pytest

from panokit.metrics import ExpansionScore

pytestmark = pytest.mark.train
pytest.importorskip("torch")


def score(irradiance: float) -> ExpansionScore:
    return ExpansionScore(
        gain=1,
        energy_ratio=1,
        beyond_clip_ratio=float("nan"),
        irradiance_mean=irradiance,
        irradiance_max=irradiance,
        light_vector_deg=10 * irradiance,
        peak_deg=3,
        ball=irradiance,
        ball_scale_invariant=irradiance,
        pu21_db=20,
        pu21_crf_db=25,
    )


@pytest.fixture
def rows():
    from panokit.train.crossval import ScoreRow

    return [
        ScoreRow(
            method=method,
            camera=camera,
            probe=f"p{index}",
            category="room" if index < 4 else "sky",
            fold=index % 5,
            score=score(base * (index + 1)),
        )
        for method, base in (("srgb", 0.2), ("recipe", 0.1))
        for camera in ("A", "B")
        for index in range(9)
    ]


def test_the_summary_holds_medians_means_and_intervals_around_them(rows):
    from panokit.train.report import summarize

    summary = summarize(rows)
    figure = summary["A"]["recipe"]["irradiance median"]
    assert figure["value"] == 0.5
    assert figure["low"] < 0.5 < figure["high"]
    assert summary["A"]["recipe"]["light vector mean (deg)"]["value"] == 5
    assert summary["categories"]["B"]["room"]["srgb"]["pictures"] == 4
    assert summary["categories"]["B"]["room"]["srgb"]["irradiance mean"] == 0.5


def test_the_same_rows_give_the_same_summary(rows):
    from panokit.train.report import summarize

    assert summarize(rows) == summarize(rows)


def test_wins_are_counted_over_the_same_pictures(rows):
    from panokit.train.report import paired_wins

    assert paired_wins(rows, "irradiance_mean", "recipe", "srgb") == (18, 18)
    assert paired_wins(rows, "irradiance_mean", "srgb", "recipe") == (0, 18)
    assert paired_wins(rows, "peak_deg", "recipe", "srgb") == (0, 18)


def test_the_table_has_a_line_for_each_method(rows):
    from panokit.train.report import markdown_table, summarize

    table = markdown_table(summarize(rows), "A").splitlines()
    assert table[0].startswith("| method | irradiance median")
    assert [line.split(" | ")[0] for line in table[2:]] == ["| srgb", "| recipe"]


def test_the_record_is_json_with_every_score(rows):
    import json

    from panokit.train.recipe import Recipe
    from panokit.train.stage import metrics_record

    record = json.loads(json.dumps(metrics_record(Recipe(id="x"), rows), allow_nan=False))
    assert len(record["rows"]) == len(rows)
    assert record["rows"][0]["beyond_clip_ratio"] is None
