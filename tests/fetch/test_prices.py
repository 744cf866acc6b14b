"""The table of prices, the user's own, and what a plan makes of them."""

import pytest

from panokit.capture import Capture, TileGrid, license_from_spdx
from panokit.errors import SettingsError
from panokit.fetch.plan import FetchPlan, plan_of
from panokit.fetch.prices import Price, price_of
from panokit.fetch.provider import Found
from panokit.fetch.sources import SOURCES
from panokit.fetch.terms import TERMS

GRID = TileGrid(width_px=4096, height_px=2048, tile_width_px=512, tile_height_px=512, zoom=3)


def panoramas(count):
    capture = Capture(provider="t", id="x", license=license_from_spdx("CC0-1.0", "me"))
    return [Found(capture=capture, grid=GRID, bytes=1000)] * count


def test_every_source_has_a_price_and_terms():
    for source in SOURCES:
        assert price_of(source).usd_per_1000 >= 0
        assert TERMS[source].summary.endswith(".")


def test_the_documented_figures():
    tiles, views = price_of("google-tiles"), price_of("google-static")
    assert (tiles.per_day, tiles.per_minute, tiles.free_per_month) == (15_000, 6_000, 100_000)
    assert (views.usd_per_1000, views.free_per_month, views.per_day) == (7.0, 10_000, None)


@pytest.mark.parametrize(("zoom_tiles", "a_day"), [(8, 1875), (32, 468), (128, 117), (512, 29)])
def test_panoramas_a_day_at_the_usual_quota(zoom_tiles, a_day):
    assert price_of("google-tiles").per_day // zoom_tiles == a_day


def test_a_plan_tells_quota_days_and_money():
    price = Price(unit="tile", usd_per_1000=2.0, free_per_month=1000, per_day=640)
    plan = plan_of(panoramas(50), price)
    assert (plan.panoramas, plan.files, plan.unit, plan.bytes) == (50, 1600, "tile", 50_000)
    assert (plan.quota_share, plan.days_at_quota) == (2.5, 3)
    assert plan.cost_usd == pytest.approx(3.2)
    assert plan.least_cost_usd == pytest.approx(1.2)


def test_a_plan_without_quota_or_price():
    plan = plan_of(panoramas(2), Price(unit="picture", usd_per_1000=0.0))
    assert (plan.quota_share, plan.days_at_quota, plan.least_cost_usd) == (None, None, 0.0)
    assert FetchPlan().least_cost_usd == 0.0


def test_all_of_it_may_be_free():
    price = Price(unit="tile", usd_per_1000=2.0, free_per_month=100_000)
    assert plan_of(panoramas(2), price).least_cost_usd == 0.0


def test_the_user_s_table_replaces_sources_one_by_one(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('[google-tiles]\nunit = "tile"\nusd_per_1000 = 1.2\nper_day = 50_000\n')
    assert price_of("google-tiles", path).usd_per_unit == pytest.approx(0.0012)
    assert price_of("google-tiles", path).free_per_month == 0
    assert price_of("google-static", path) == price_of("google-static")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[google-tiles", "not a TOML table"),
        ("[google-tiles]\nunit = 'tile'\n", "usd_per_1000"),
        ("[google-tiles]\nunit = 'tile'\nusd_per_1000 = 1\nper_hour = 3\n", "a price has"),
        ("[google-tiles]\nunit = 'tile'\nusd_per_1000 = -1\n", "usd_per_1000 = -1"),
        ("[google-tiles]\nunit = 'tile'\nusd_per_1000 = '2'\n", "usd_per_1000 = '2'"),
        ("[google-tiles]\nunit = 'tile'\nusd_per_1000 = nan\n", "usd_per_1000 = nan"),
        ("[google-tiles]\nunit = 'tile'\nusd_per_1000 = 1\nper_day = 0\n", "per_day = 0"),
        ("google-tiles = 2\n", "[google-tiles]"),
    ],
)
def test_a_table_that_is_none_says_where(tmp_path, text, says):
    path = tmp_path / "mine.toml"
    path.write_text(text)
    with pytest.raises(SettingsError) as caught:
        price_of("google-tiles", path)
    assert says in str(caught.value)
    assert "mine.toml" in str(caught.value)
