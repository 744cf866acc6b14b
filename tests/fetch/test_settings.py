"""The settings of fetch: what contradicts itself is refused, and every file of cities is known."""

from pathlib import Path

import pytest
from pydantic import ValidationError

from panokit.fetch import FetchSettings
from panokit.fetch.sources import SOURCES
from panokit.fetch.where import places_of

CITY_LISTS = sorted((Path(__file__).parents[2] / "pipelines" / "cities").glob("*.txt"))


@pytest.mark.parametrize(
    "wrong",
    [
        {"endpoint": "panoramax.example.org"},
        {"bbox": (7.1, 48.0, 7.0, 48.1)},
        {"date_from": "2024-02-01", "date_to": "2024-01-01"},
        {"folder": "pictures"},
        {"zoom": 6},
        {"source": "elsewhere"},
        {"citys": ("Paris",)},
    ],
    ids=lambda wrong: next(iter(wrong)),
)
def test_contradictions_are_refused(wrong):
    with pytest.raises(ValidationError):
        FetchSettings.model_validate(wrong)


def test_every_source_of_the_settings_exists():
    assert set(FetchSettings.model_fields["source"].annotation.__args__) == set(SOURCES)


def test_places_come_from_toml_though_not_from_the_command_line():
    own = {"name": "Ours", "latitude_deg": 1.0, "longitude_deg": 2.0}
    assert FetchSettings.model_validate({"places": [own]}).places[0].name == "Ours"


def test_every_setting_says_what_it_is():
    assert all(field.description for field in FetchSettings.model_fields.values())


@pytest.mark.parametrize("path", CITY_LISTS, ids=lambda path: path.stem)
def test_the_cities_of_every_shipped_list_are_known(path):
    assert len(places_of(FetchSettings(city_list=path))) >= 5


def test_there_are_lists():
    assert CITY_LISTS
