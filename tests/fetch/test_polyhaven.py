"""Poly Haven: what is chosen and checked, and `panokit probes pull` against the look-alike."""

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest

from panokit.cli.main import main
from panokit.errors import ItemError, NetworkError, UsageError
from panokit.fetch.polyhaven import capture_of, check_file, parse_files, select
from panokit.fetch.settings import PullSettings
from panokit.probes import Library
from panokit.synthetic.faults import Faults, Trouble

DATA = Path(__file__).parent / "data"
ASSETS = json.loads((DATA / "polyhaven_assets.json").read_bytes())
FILES = (DATA / "polyhaven_files.json").read_bytes()
SUNNY = capture_of("a_sunny_street", ASSETS["a_sunny_street"])


def chosen(**settings):
    return [capture.id for capture in select(ASSETS, PullSettings(**settings))]


@pytest.mark.parametrize(
    ("settings", "names"),
    [
        ({"names": ("a_quiet_street", "a_sunny_street")}, ["a_quiet_street", "a_sunny_street"]),
        ({"names": ("a_quiet_street",) * 2}, ["a_quiet_street"]),
        # The most downloaded first; the brick floor is a texture.
        ({"category": ("urban",)},
         ["a_sunny_street", "abandoned_factory_canteen_01", "a_quiet_street"]),
        ({"category": ("urban", "outdoor")}, ["a_sunny_street", "a_quiet_street"]),
        ({"query": "street"}, ["a_sunny_street", "a_quiet_street"]),
        ({"query": "Street SUN"}, ["a_sunny_street"]),
        ({"query": "fluorescent"}, ["abandoned_factory_canteen_01"]),
        ({"query": "street", "count": 1}, ["a_sunny_street"]),
        ({"query": "volcano"}, []),
    ],
)  # fmt: skip
def test_what_is_chosen(settings, names):
    assert chosen(**settings) == names


def test_an_unknown_name_is_told():
    with pytest.raises(UsageError, match="brick_floor_003"):
        chosen(names=("a_sunny_street", "brick_floor_003"))


@pytest.mark.parametrize("reply", [[], None, {"x": 1}])
def test_another_service_is_not_taken_for_poly_haven(reply):
    with pytest.raises(NetworkError, match="Poly Haven"):
        select(reply, PullSettings(count=1))


def test_what_is_known_of_a_map():
    capture = capture_of("abandoned_factory_canteen_01", ASSETS["abandoned_factory_canteen_01"])
    assert (capture.latitude_deg, capture.longitude_deg) == (50.995194, 35.105417)
    assert capture.license.id == "CC0-1.0"
    assert capture.license.train
    assert "Sergej Majboroda via Poly Haven" in capture.license.attribution
    # The service does not stand by the time a map was taken.
    assert capture.time is None
    assert (capture.details["brackets_ev"], capture.details["white_balance_k"]) == (15, 5450)
    assert "Greg Zaal, Jarod Guest" in SUNNY.license.attribution
    assert SUNNY.latitude_deg is None


@pytest.mark.parametrize(
    ("resolution", "format", "name", "megabytes"),
    [("4k", "exr", "a_sunny_street_4k", 23.0), ("16k", "hdr", "a_sunny_street_4k", 24.0),
     ("2k", "exr", "a_sunny_street_1k", 1.4)],
)  # fmt: skip
def test_the_file_wanted_or_the_next_smaller_one(resolution, format, name, megabytes):
    remote = parse_files(FILES, SUNNY, PullSettings(resolution=resolution, format=format))
    assert (remote.name, remote.bytes, remote.suffix) == (name, megabytes * 1e6, f".{format}")
    assert remote.capture.width_px == 2 * remote.capture.height_px


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        (b'{"hdri": {"8k": {"exr": {}}}}', "no-file"),
        (b'{"hdri": {"1k": {"hdr": {}}}}', "no-file"),
        (b'{"hdri": {"1k": {"exr": {"url": "x", "size": 3}}}}', "bad-metadata"),
        (b'{"hdri": {"1k": {"exr": {"url": "x", "size": 3, "md5": "short"}}}}', "bad-metadata"),
        (b'{"Diffuse": {}}', "bad-metadata"),
        (b"[]", "bad-metadata"),
    ],
)
def test_lists_without_it(body, reason):
    with pytest.raises(ItemError) as caught:
        parse_files(body, SUNNY, PullSettings(resolution="2k"))
    assert caught.value.reason == reason


def test_a_file_must_have_the_digest_that_was_promised():
    remote = parse_files(FILES, SUNNY, PullSettings(resolution="1k"))
    body = bytes(remote.bytes)
    digest = hashlib.md5(body, usedforsecurity=False).hexdigest()
    good = type(remote)(
        capture=SUNNY, resolution="1k", address="", bytes=len(body), md5=digest, suffix=".exr"
    )
    check_file(body, good)
    for wrong in (body[:-1], body[:-1] + b"x"):
        with pytest.raises(ItemError, match="MD5"):
            check_file(wrong, good)


def pull(server, library, *more):
    return main(
        ["probes", "pull", str(library), *more, "--endpoint", server.url, "--resolution", "1k",
         "--requests-per-s", "1000"]
    )  # fmt: skip


def storage_asked(server):
    return [request.path for request in server.requests if request.port == "storage"]


def test_maps_are_pulled_once(server, tmp_path, capsys):
    library = tmp_path / "lib"
    (library / ".incoming").mkdir(parents=True)
    (library / ".incoming" / "killed.part").write_bytes(b"half")
    assert pull(server, library, "pano-3328") == 0
    assert pull(server, library, "pano-3328", "pano-5376") == 0
    assert len(storage_asked(server)) == 2
    assert pull(server, library, "pano-3328", "pano-5376") == 0
    assert len(storage_asked(server)) == 2
    output = capsys.readouterr()
    assert "0 added (0 B), 2 there already, 0 rejected" in output.out.splitlines()[-1]
    assert "Powered by Poly Haven" in output.err
    with Library.open(library) as shelves:
        entries = shelves.list()
        probe = shelves.show(entries[0].id)
    assert [entry.name for entry in entries] == ["pano-3328_1k", "pano-5376_1k"]
    assert (probe.license.id, probe.width_px) == ("CC0-1.0", 1024)
    assert probe.capture.provider == "polyhaven"
    # What came is in the library; the file itself is not kept a second time.
    assert not [path for path in library.rglob("*") if "incoming" in path.name]


def test_a_dry_run_pulls_nothing(server, tmp_path, capsys):
    library = tmp_path / "lib"
    assert pull(server, library, "--count", "2", "--dry-run") == 0
    output = capsys.readouterr().out
    assert "Would pull 2 maps" in output
    assert max(map(len, output.splitlines())) <= 80
    assert not library.exists()
    assert storage_asked(server) == []


def test_damage_on_the_way_is_mended_by_asking_again(server, tmp_path):
    server.set_faults(
        Faults(troubles=[Trouble(kind=kind, path="/file/") for kind in ("truncated", "500")])
    )
    assert pull(server, tmp_path / "lib", "pano-3328") == 0
    assert len(storage_asked(server)) == 3


def test_a_map_that_is_gone_is_rejected_and_the_next_goes_on(server, tmp_path, capsys):
    server.set_faults(Faults(retired=frozenset({"pano-5376"})))
    assert pull(server, tmp_path / "lib", "pano-5376", "pano-3328", "--json") == 1
    told = json.loads(capsys.readouterr().out)
    assert [one["name"] for one in told["added"]] == ["pano-3328_1k"]
    assert [one["reason"] for one in told["rejected"]] == ["not-found"]


def test_one_must_say_what_to_pull(server, tmp_path, capsys):
    assert pull(server, tmp_path / "lib") == 2
    assert "--category" in capsys.readouterr().err
    assert pull(server, tmp_path / "lib", "no-such-map") == 2


def test_the_light_is_that_of_the_file(server, tmp_path):
    assert pull(server, tmp_path / "lib", "pano-3328", "--format", "hdr") == 0
    with Library.open(tmp_path / "lib") as shelves:
        (entry,) = shelves.list()
        from panokit.io import read_environment_map

        envmap = read_environment_map(shelves.map_path(entry.id))
    assert np.isfinite(envmap.radiance).all()
    assert envmap.radiance.max() > 0
