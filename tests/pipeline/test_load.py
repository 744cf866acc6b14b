import re
from pathlib import Path

import pytest

from panokit.errors import SettingsError, StorageError
from panokit.pipeline import PipelineSettings, load_settings
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


@pytest.mark.parametrize(
    "path", sorted(shipped_path("pipelines").glob("*.toml")), ids=lambda path: path.name
)
def test_every_shipped_pipeline_loads(path):
    settings = load_settings(path, PipelineSettings)
    assert settings.fetch.source == "panoramax"
