"""A virtual camera over real panoramas: what a click selects is followed."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

from panokit.lighting import follow, select_object
from panokit.lighting.settings import TrackSettings
from tests.lighting.panned import THINGS, PannedFrames, true_box

pytestmark = [pytest.mark.data, pytest.mark.slow]
EASY = [thing for thing in THINGS if thing.selectable]


def overlaps(thing, tracker):
    folder = Path(os.environ["PANOKIT_DATA"]) / "panoramas"
    frames = PannedFrames(folder, thing)
    column, row, _ = frames.views[0].project(thing.clicked()[None])
    selection = select_object(frames.frame(0), (float(column[0]), float(row[0])))
    found, lost = [], 0
    for one, _ in follow(frames, selection, 0, TrackSettings(tracker=tracker)):
        found.append(one.box.overlap(true_box(thing, frames.views[one.number])))
        lost += one.state == "lost"
    return np.array(found), lost


@pytest.mark.skipif("PANOKIT_DATA" not in os.environ, reason="PANOKIT_DATA is not set")
@pytest.mark.parametrize("tracker", ["kcf", "csrt"])
def test_objects_of_real_places_are_selected_and_followed(tracker, capsys, tmp_path):
    rows = []
    for thing in EASY:
        found, lost = overlaps(thing, tracker)
        rows.append((thing.name, found[0], (found >= 0.5).mean(), found.mean(), lost))
        with capsys.disabled():
            print(
                "\n{:10s} selected {:.2f} kept {:.0%} mean {:.2f} lost {}".format(*rows[-1]), end=""
            )
        # What is off and not told as lost would be silent.
        assert ((found < 0.3).sum()) <= lost, thing.name
    (tmp_path / "trial.json").write_text(json.dumps(rows, default=float))
    assert len(rows) >= 10
    assert all(first >= 0.5 for _, first, _, _, _ in rows)
    assert np.mean([kept for _, _, kept, _, _ in rows]) >= 0.9
