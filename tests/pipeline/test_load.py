import re
from datetime import date
from pathlib import Path
from typing import get_args

import pytest

from panokit.errors import SettingsError, StorageError
from panokit.evaluate.lighting.scoring import FIGURES
from panokit.fetch.where import total_wanted
from panokit.metrics.protocols import protocol
from panokit.pipeline import PipelineSettings, load_settings
from panokit.pipeline.serving import served_asks
from panokit.pipeline.settings import Figure
from panokit.shipped import shipped_path

GOOD = """name = "mine"

[fetch]
cities = ["Lyon, FR"]
count = 3

[expand]
width_px = 512
"""


def load(tmp_path, text, *overrides):
    path = tmp_path / "p.toml"
    path.write_text(text)
    return load_settings(path, PipelineSettings, overrides)


def test_a_good_file(tmp_path):
    settings = load(tmp_path, GOOD)
    assert (settings.name, settings.fetch.count, settings.expand.width_px) == ("mine", 3, 512)
    assert settings.folder() == Path("runs/mine")


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (GOOD.replace("count", "cuont"), "line 5: there is no setting 'fetch.cuont'. "
         "Did you mean 'count'?"),
        (GOOD.replace("[expand]", "[expnad]"), "line 7: there is no setting 'expnad'. "
         "Did you mean 'expand'?"),
        (GOOD.replace("512", "-4"), "line 8: expand.width_px = -4: "),
        (GOOD.replace('name = "mine"', ""), "the setting 'name' is missing"),
        (GOOD.replace("count = 3", "count ="), "is not a TOML file"),
        (GOOD + "\nzzzzzz = 1\n", "Known keys: model, width_px"),
    ],
)  # fmt: skip
def test_slips_name_the_line_and_the_nearest_key(tmp_path, wrong, message):
    with pytest.raises(SettingsError, match=re.escape(message)) as caught:
        load(tmp_path, wrong)
    assert "\n" not in str(caught.value)


def test_settings_can_be_replaced_from_the_command_line(tmp_path):
    settings = load(tmp_path, GOOD, "fetch.count=7", "name=other", 'expand.model="srgb"')
    assert (settings.fetch.count, settings.name, settings.expand.model) == (7, "other", "srgb")
    with pytest.raises(SettingsError, match="NAME=VALUE"):
        load(tmp_path, GOOD, "fetch.count")
    with pytest.raises(SettingsError, match="is a value, not a table"):
        load(tmp_path, GOOD, "name.x=1")


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(StorageError, match="Check the path"):
        load_settings(tmp_path / "no.toml", PipelineSettings)


def test_a_file_extends_another_table_by_table(tmp_path):
    (tmp_path / "lists").mkdir()
    (tmp_path / "lists" / "base.toml").write_text(
        GOOD.replace('cities = ["Lyon, FR"]', 'city_list = "towns.txt"')
    )
    settings = load(tmp_path, 'extends = "lists/base.toml"\nname = "own"\n[fetch]\ncount = 9\n')
    assert (settings.name, settings.fetch.count, settings.expand.width_px) == ("own", 9, 512)
    # What is read lies beside the file that names it.
    assert settings.fetch.city_list == tmp_path / "lists" / "towns.txt"


def test_a_slip_in_an_extended_file_names_that_file(tmp_path):
    (tmp_path / "base.toml").write_text(GOOD.replace("count", "cuont"))
    with pytest.raises(SettingsError, match=r"base\.toml, line 5: .*'fetch\.cuont'"):
        load(tmp_path, 'extends = "base.toml"\n')


def test_files_that_extend_each_other_are_refused(tmp_path):
    (tmp_path / "b.toml").write_text('extends = "p.toml"\n')
    with pytest.raises(SettingsError, match=r"p\.toml -> b\.toml -> p\.toml"):
        load(tmp_path, 'extends = "b.toml"\n')
    with pytest.raises(SettingsError, match=r"line 2: .*name one file"):
        load(tmp_path, '\nextends = ["b.toml"]\n')


AREAS = """name = "many"
[[areas]]
cities = ["Lyon, FR"]
count = 3

[[areas]]
cities = ["Paris, FR", "Nice, FR"]
date_from = 2021-05-01
licenses = ["CC0-1.0"]

[fetch]
count = 7
"""


def test_areas_have_counts_dates_and_licenses_of_their_own(tmp_path):
    lyon, others = load(tmp_path, AREAS).asks()
    assert (lyon.cities, lyon.count, lyon.date_from) == (("Lyon, FR",), 3, None)
    assert (others.cities, others.count) == (("Paris, FR", "Nice, FR"), 7)
    assert others.date_from == date(2021, 5, 1)
    assert (lyon.licenses, others.licenses) == ((), ("CC0-1.0",))
    own, *_ = load(tmp_path, AREAS + 'cities = ["Brest, FR"]\n').asks()
    assert own.cities == ("Brest, FR",)
    assert load(tmp_path, AREAS, "areas.1.count=2").asks()[1].count == 2


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (AREAS.replace("date_from", "date_form"), "line 8: there is no setting "
         "'areas.1.date_form'. Did you mean 'date_from'?"),
        (AREAS.replace("count = 3", "count = 0"), "line 4: areas.0.count = 0: "),
        ('name = "x"\n[train]\nid = "t"\n', "train needs the table dataset"),
        ('name = "x"\nengine = "spark"\n', "line 2: engine = 'spark'"),
    ],
)  # fmt: skip
def test_slips_in_areas_and_stages(tmp_path, wrong, message):
    with pytest.raises(SettingsError, match=re.escape(message)):
        load(tmp_path, wrong)


def test_an_area_without_a_place_is_refused(tmp_path):
    settings = load(tmp_path, 'name = "x"\n[[areas]]\ncount = 3\n')
    with pytest.raises(SettingsError, match="area 1 names no place"):
        settings.asks()


@pytest.mark.parametrize("override", ["areas.5.count=1", "areas.x=1"])
def test_an_area_that_is_not_there_cannot_be_set(tmp_path, override):
    with pytest.raises(SettingsError, match="no number from 0 to 1"):
        load(tmp_path, AREAS, override)


@pytest.mark.parametrize(
    "path", sorted(shipped_path("pipelines").glob("*.toml")), ids=lambda path: path.name
)
def test_every_shipped_pipeline_loads(path):
    settings = load_settings(path, PipelineSettings)
    assert settings.fetch.source == "panoramax"
    for ask in served_asks(settings):
        assert total_wanted(ask) > 0


def test_the_figures_that_decide_are_figures_of_which_less_is_better():
    for name in get_args(Figure):
        assert name in FIGURES
        assert protocol(name).better == "lower"
