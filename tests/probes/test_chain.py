"""The chain in words: capture, every step, the library."""

from dataclasses import replace
from datetime import UTC, datetime

from panokit.capture import TimePrecision
from panokit.probes import Library, chain_lines
from panokit.provenance import Provenance, Step


def test_every_link_is_told_in_order(tmp_path, make_map):
    steps = (
        Step(stage="stitch", version="3", input_digests=("ab" * 32, "cd" * 32),
             values={"tiles": 91, "leveling": {"pitch": 1}, "missing": []}),
        Step(stage="expand", version="4", settings_digest="ef" * 32, weights_digest="12" * 32,
             values={"model": "expand-2", "burnt_share": 0.0123456789, "limited": True}),
    )  # fmt: skip
    envmap = make_map(1).with_changes(provenance=Provenance(steps))
    with Library.create(tmp_path) as library:
        lines = chain_lines(library.add(envmap).probe)
    assert [stage for stage, _ in lines] == ["capture", "stitch", "expand", "probe"]
    text = dict(lines)
    assert text["capture"] == "panoramax picture-1, Bristol"
    assert text["stitch"] == "version 3, tiles 91, from ababababab and 1 more"
    assert text["expand"] == (
        "version 4, burnt share 0.0123457, model expand-2, settings efefefefef, weights 1212121212"
    )
    assert text["probe"].startswith("probe.exr, sha256 ")


def test_a_time_is_told_as_precisely_as_it_is_known(tmp_path, make_map):
    envmap = make_map(1)
    capture = envmap.capture
    changed = {
        "time": datetime(2024, 5, 1, tzinfo=UTC),
        "time_precision": TimePrecision.MONTH,
        "latitude_deg": 51.45,
        "longitude_deg": -2.58,
    }
    with Library.create(tmp_path) as library:
        probe = library.add(envmap.with_changes(capture=replace(capture, **changed))).probe
        bare = library.add(envmap.with_changes(capture=None)).probe
    assert chain_lines(probe)[0][1].endswith("Bristol, 51.45000 -2.58000, 2024-05")
    assert chain_lines(bare)[0] == ("capture", "not known")
