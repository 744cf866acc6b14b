"""The whole stage against the look-alike services, over real HTTP."""

import threading
from dataclasses import replace

import numpy as np
import pytest

from panokit.errors import LicenseError, NetworkError, OutageError, QuotaError, StorageError
from panokit.fetch import PlaceSettings, fetch
from panokit.http import Client, Policy
from panokit.io import read_capture
from panokit.io.captures import RECORD, write_capture
from panokit.io.files import read_json, write_synced
from panokit.io.images import encode_jpeg
from panokit.synthetic import ServedPicture, StreetServer
from panokit.synthetic.fault_language import parse_faults
from panokit.synthetic.faults import Faults, Trouble
from panokit.synthetic.google_tiles import GoogleTiles
from tests.fetch.conftest import KEY, STREET, WIDTHS_PX, folders, google, panoramax

SMALL = "pano-3328"
NOWHERE = PlaceSettings(name="Nowhere", latitude_deg=-40, longitude_deg=-100)


def tiles_asked(server) -> int:
    return sum("/tiles/" in request.path for request in server.requests)


def incomplete(out) -> list[str]:
    return [name for name in folders(out) if not (out / "captures" / name / RECORD).exists()]


def test_panoramax_pictures_are_stored_whole(server, tmp_path):
    # The small half of the street: a JPEG of 16384 px would take most of the test's time.
    near = PlaceSettings(name="End", latitude_deg=48.5025, longitude_deg=7.7, radius_m=100)
    result = fetch(panoramax(server, places=(near,), count=2), tmp_path)
    assert {one.capture.id for one in result.stored} == {"pano-5376", SMALL}
    for one in result.stored:
        stored = read_capture(one.folder)
        assert stored.read("image.jpg").startswith(b"\xff\xd8")
        assert stored.grid is None
        assert stored.capture.place == "End"
        assert stored.capture.license.id == "CC-BY-4.0"
        assert read_json(one.folder / RECORD)["raw"]["id"] == stored.capture.id
    assert server.violations == []


def test_google_tiles_of_all_four_sizes(server, tmp_path):
    result = fetch(google(server), tmp_path)
    widths = {one.capture.width_px: one for one in result.stored}
    assert set(widths) == set(WIDTHS_PX)
    for width_px, one in widths.items():
        stored = read_capture(one.folder)
        assert len(stored.files) == stored.grid.columns * stored.grid.rows
        assert all(stored.read(name) for name in stored.files)
        assert (stored.capture.width_px, stored.grid.zoom) == (width_px, 2)
        assert stored.capture.roll_deg == pytest.approx(-2.0)
        assert stored.capture.license.id == "google-maps-platform"
    assert tiles_asked(server) == sum(len(one.files) for one in result.stored)


def test_a_second_run_asks_for_nothing(server, tmp_path):
    first = fetch(google(server), tmp_path)
    asked = len(server.requests)
    second = fetch(google(server), tmp_path)
    assert first.short == second.short == {}
    assert (second.stored, second.requests, len(server.requests)) == ((), 0, asked)
    assert {one.capture.key for one in second.existing} == {one.capture.key for one in first.stored}


def test_a_larger_count_keeps_what_is_there(server, tmp_path):
    first = fetch(google(server, count=2), tmp_path)
    more = fetch(google(server, count=4), tmp_path)
    assert len(first.stored) == len(more.stored) == len(more.existing) == 2
    assert len(folders(tmp_path)) == 4
    at_once = fetch(google(server, count=4), tmp_path / "other")
    assert [one.capture.id for one in at_once.stored][:2] == [
        one.capture.id for one in first.stored
    ]


def test_a_place_by_another_name_is_the_same_place(server, tmp_path):
    fetch(google(server), tmp_path)
    renamed = google(server, places=(STREET.model_copy(update={"name": "The other name"}),))
    assert len(fetch(renamed, tmp_path).existing) == 4


def test_a_shortage_says_what_was_passed_over(server, tmp_path):
    events = []
    result = fetch(google(server, min_distance_m=5000), tmp_path, report=events.append)
    (short,) = (event for event in events if event.kind == "short")
    assert "1 of 4" in short.message
    assert "3 too-close" in short.message
    assert "a larger radius, a smaller minimum distance" in short.message
    assert (result.short, result.rejections) == ({STREET.name: (1, 4)}, ())


def test_remedies_fit_the_place(server, tmp_path):
    result = fetch(google(server, places=(), bbox=(1.0, 1.0, 1.1, 1.1)), tmp_path)
    (nothing,) = result.rejections
    assert "a larger box" in nothing.message
    assert "radius" not in nothing.message
    assert "minimum distance" not in nothing.message
    assert nothing.item not in nothing.message


@pytest.mark.parametrize("kind", ["429", "429-body", "500", "html", "truncated"])
def test_passing_troubles_leave_no_trace(server, tmp_path, kind):
    calm = fetch(google(server), tmp_path / "calm")
    server.set_faults(Faults(troubles=[Trouble(kind=kind, path="/tiles/", times=12)]))
    rough = fetch(google(server), tmp_path / "rough")
    assert [one.files for one in rough.stored] == [one.files for one in calm.stored]
    assert rough.requests > calm.requests


@pytest.mark.parametrize(
    "faults",
    [
        Faults(edge_tiles="cropped", out_of_range="not-found"),
        Faults(tile_body_px=256),
        Faults(sparse_metadata=True),
        Faults(session_lifetime_s=1.0),
    ],
    ids=["cropped edges", "small bodies", "sparse metadata", "short session"],
)
def test_odd_servers(server, tmp_path, faults):
    server.set_faults(faults)
    result = fetch(google(server), tmp_path)
    assert len(result.stored) == 4
    assert result.rejections == ()


def test_a_small_tile_is_asked_for_twice_more(server, tmp_path):
    server.set_faults(Faults(tile_body_px=256))
    result = fetch(google(server, count=1), tmp_path)
    assert tiles_asked(server) == 3 * len(result.stored[0].files)


def test_a_missing_tile_rejects_its_panorama(server, tmp_path):
    server.set_faults(Faults(missing_tiles=frozenset({(2, 3, 1)})))
    result = fetch(google(server), tmp_path)
    # 5376 px are 1344 px at zoom 2: three columns, so that this picture never had the tile.
    assert [one.capture.width_px for one in result.stored] == [5376]
    assert len(result.rejections) == 3
    lost = result.rejections[0]
    assert (lost.reason, lost.stage, lost.values["cause"]) == ("missing-tile", "fetch", "not-found")
    assert "tiles/3_1.jpg" in lost.message
    assert result.verdicts == ()
    assert incomplete(tmp_path) == []
    assert lost.item not in folders(tmp_path)


def test_or_becomes_a_hole_that_is_recorded(server, tmp_path):
    server.set_faults(Faults(missing_tiles=frozenset({(2, 3, 1)})))
    result = fetch(google(server, allow_missing=True), tmp_path)
    assert result.rejections == ()
    holes = {one.capture.width_px: read_capture(one.folder).grid.missing for one in result.stored}
    assert holes == {16384: ((3, 1),), 13312: ((3, 1),), 5376: (), 3328: ((3, 1),)}


@pytest.mark.parametrize("settings", [google, panoramax], ids=["google", "panoramax"])
def test_a_retired_panorama_is_a_verdict_to_remember(server, tmp_path, settings):
    server.set_faults(Faults(retired=frozenset({"pano-16384", "pano-13312", "pano-5376"})))
    result = fetch(settings(server), tmp_path)
    assert [one.capture.id for one in result.stored] == [SMALL]
    verdicts = {one.item for one in result.verdicts}
    assert len(verdicts) == 3
    assert {one.reason for one in result.verdicts} == {"retired"}
    again = fetch(settings(server, count=2), tmp_path, known=verdicts)
    assert again.verdicts == ()


def test_a_place_without_pictures_is_rejected_and_the_next_goes_on(server, tmp_path):
    events = []
    settings = google(server, places=(NOWHERE, STREET), count=5)
    result = fetch(settings, tmp_path, report=events.append)
    assert [(one.item, one.reason) for one in result.rejections] == [("Nowhere", "no-imagery")]
    assert len(result.stored) == 4
    assert [event.item for event in events if event.kind == "short"] == ["Nowhere", STREET.name]
    assert [event.done for event in events if event.kind == "stored"] == [1, 2, 3, 4]


def test_a_dry_run_says_what_it_would_take(server, tmp_path):
    result = fetch(google(server, dry_run=True), tmp_path)
    assert folders(tmp_path) == set()
    assert tiles_asked(server) == 0
    real = fetch(google(server), tmp_path)
    tiles = sum(len(one.files) for one in real.stored)
    assert (result.plan.panoramas, result.plan.files) == (4, tiles)
    assert result.plan.cost_usd == pytest.approx(tiles * 0.002)
    assert result.plan.quota_share == pytest.approx(tiles / 15000)
    assert (result.plan.days_at_quota, result.plan.unit) == (1, "tile")
    assert result.plan.bytes > 0
    assert real.plan is None


def test_the_budget_ends_a_run_between_panoramas(server, tmp_path):
    with pytest.raises(QuotaError, match="max_requests"):
        fetch(google(server, max_requests=25), tmp_path)
    assert len(server.requests) <= 25
    assert 1 <= len(folders(tmp_path)) < 4
    assert incomplete(tmp_path) == []
    rest = fetch(google(server), tmp_path)
    assert len(rest.stored) + len(rest.existing) == 4


def test_money_ends_a_run_too(server, tmp_path):
    with pytest.raises(QuotaError, match="USD"):
        fetch(google(server, max_cost_usd=0.03), tmp_path)
    assert tiles_asked(server) * 0.002 <= 0.03
    assert incomplete(tmp_path) == []


def test_an_interrupt_leaves_whole_captures_only(server, tmp_path):
    def interrupt(event):
        if event.kind == "stored":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fetch(google(server), tmp_path, report=interrupt)
    assert len(folders(tmp_path)) == 1
    assert incomplete(tmp_path) == []
    assert not [one for one in threading.enumerate() if "panokit-fetch" in one.name]
    assert len(fetch(google(server), tmp_path).stored) == 3


def test_an_interrupt_right_after_the_record_loses_nothing(server, tmp_path, monkeypatch):
    def interrupt(stored, raw=None):
        write_capture(stored, raw)
        raise KeyboardInterrupt

    monkeypatch.setattr("panokit.fetch.store.write_capture", interrupt)
    with pytest.raises(KeyboardInterrupt):
        fetch(google(server), tmp_path)
    assert len(folders(tmp_path)) == 1
    assert incomplete(tmp_path) == []


def test_what_a_killed_run_left_is_replaced(server, tmp_path):
    calm = fetch(google(server, count=1), tmp_path / "calm").stored[0]
    left = tmp_path / "captures" / calm.capture.key / "tiles"
    left.mkdir(parents=True)
    (left / "0_0.jpg").write_bytes(b"half")
    (left / "99_0.jpg.part").write_bytes(b"")
    again = fetch(google(server, count=1), tmp_path).stored[0]
    assert again.files == calm.files
    assert {f"tiles/{path.name}" for path in left.iterdir()} == set(calm.files)


def test_a_damaged_record_is_fetched_again(server, tmp_path):
    one = fetch(google(server, count=1), tmp_path).stored[0]
    (one.folder / RECORD).write_text("{")
    again = fetch(google(server, count=1), tmp_path)
    assert [other.files for other in again.stored] == [one.files]


def test_nobody_answers(tmp_path, server):
    settings = panoramax(server, endpoint="http://127.0.0.1:9")
    impatient = Client(Policy(attempts=2, first_delay_s=0.01))
    with impatient, pytest.raises(NetworkError, match="no connection"):
        fetch(settings, tmp_path, client=impatient)


def test_an_endpoint_of_another_kind(server, tmp_path):
    with pytest.raises(NetworkError, match="Panoramax server"):
        fetch(panoramax(server, endpoint=server.url + "/elsewhere"), tmp_path)


def test_terms_come_before_any_request(server, tmp_path):
    with pytest.raises(LicenseError, match="accept-terms"):
        fetch(google(server, accept_terms=()), tmp_path)
    assert server.requests == []


def test_a_full_disk_leaves_whole_captures_only(server, tmp_path, monkeypatch):
    written = []

    def write_a_few(path, data):
        written.append(path)
        if len(written) > 12:
            raise StorageError("The disk is full.")
        write_synced(path, data)

    monkeypatch.setattr("panokit.fetch.store.write_synced", write_a_few)
    with pytest.raises(StorageError, match="full"):
        fetch(google(server), tmp_path)
    assert incomplete(tmp_path) == []


def test_a_file_where_the_run_should_go(server, tmp_path):
    (tmp_path / "run").write_text("")
    with pytest.raises(StorageError):
        fetch(google(server), tmp_path / "run")


def test_a_black_tile_is_a_tile_that_cannot_be_had(server, tmp_path):
    server.set_faults(Faults(black_tiles=frozenset({(2, 3, 1)})))
    result = fetch(google(server), tmp_path)
    assert [one.capture.width_px for one in result.stored] == [5376]
    assert {one.values["cause"] for one in result.rejections} == {"black-tile"}
    assert result.verdicts == ()
    assert incomplete(tmp_path) == []


def test_or_a_hole_too(server, tmp_path):
    server.set_faults(Faults(black_tiles=frozenset({(2, 3, 1)})))
    result = fetch(google(server, allow_missing=True), tmp_path)
    holes = {one.capture.width_px: read_capture(one.folder).grid.missing for one in result.stored}
    assert holes[16384] == ((3, 1),)
    assert not (result.stored[0].folder / "tiles/3_1.jpg").exists()


def test_a_tile_that_is_black_for_a_moment_is_asked_for_again(server, tmp_path):
    calm = fetch(google(server), tmp_path / "calm")
    server.set_faults(parse_faults("black 10% first=1 at=/tiles/, seed=1"))
    rough = fetch(google(server), tmp_path / "rough")
    assert server.faults_met["black"] > 2
    assert [one.files for one in rough.stored] == [one.files for one in calm.stored]


def test_metadata_that_promises_too_much_is_noticed(server, tmp_path, monkeypatch):
    # The service says 16384 px and has 13312: black bars at the right and at the foot.
    lies = {"imageWidth": 16384, "imageHeight": 8192}
    honest = GoogleTiles._description
    monkeypatch.setattr(
        GoogleTiles, "_description", lambda *args, **more: honest(*args, **more) | lies
    )
    near = STREET.model_copy(update={"latitude_deg": 48.501, "radius_m": 20})
    result = fetch(google(server, places=(near,), count=1), tmp_path)
    assert result.stored == ()
    assert [one.reason for one in result.rejections] == ["black-columns", "no-imagery"]
    assert result.verdicts == ()


def test_a_key_that_the_server_echoes_is_not_kept(server, tmp_path, monkeypatch):
    honest = GoogleTiles._description
    monkeypatch.setattr(
        GoogleTiles,
        "_description",
        lambda *args, **more: honest(*args, **more) | {"reportProblemLink": f"https://x/?k={KEY}"},
    )
    fetch(google(server), tmp_path)
    for path in tmp_path.rglob("*"):
        assert not path.is_file() or KEY.encode() not in path.read_bytes(), path


def test_a_broken_picture_does_not_end_the_run_and_an_outage_does(server, tmp_path):
    quick = Policy(attempts=2, first_delay_s=0.01, rate_per_s=1000, failures_in_a_row=1000)
    server.set_faults(parse_faults("500 100% at=/tiles/2/3/"))
    with Client(quick) as client:
        result = fetch(google(server), tmp_path, client=client)
    assert {one.reason for one in result.rejections} == {"network"}
    assert len(result.stored) == 1
    server.set_faults(parse_faults("html 100% at=/tiles/"))
    down = replace(quick, attempts=50, outage_pauses_s=(0.1,))
    with Client(down) as client, pytest.raises(OutageError, match="browser"):
        fetch(google(server), tmp_path, client=client)
    assert incomplete(tmp_path) == []


def test_a_black_tile_among_tiles_rich_in_detail(pictures, tmp_path, monkeypatch):
    monkeypatch.setenv("GOOGLE_MAPS_API_KEY", KEY)
    noise = np.random.default_rng(0).integers(60, 220, (832, 1664, 3), np.uint8)
    image = tmp_path / "noise.jpg"
    image.write_bytes(encode_jpeg(noise))
    detailed = [ServedPicture(capture=pictures[3].capture, image=image)]
    faults = Faults(black_tiles=frozenset({(2, 1, 0)}))
    with StreetServer(detailed, key=KEY, faults=faults) as server:
        near = STREET.model_copy(update={"latitude_deg": 48.503, "radius_m": 30})
        settings = google(server, places=(near,), count=1)
        (lost, _) = fetch(settings, tmp_path / "run").rejections
        (taken,) = fetch(
            google(server, places=(near,), count=1, allow_missing=True), tmp_path / "run"
        ).stored
    assert (lost.values["cause"], lost.values["tile"]) == ("black-tile", "tiles/1_0.jpg")
    assert taken.grid.missing == ((1, 0),)
    assert (taken.folder / "tiles/0_0.jpg").stat().st_size > 20_000
