import re

import numpy as np
import pytest
from PIL import Image

from panokit.dataset.cards.card import card_text
from panokit.dataset.cards.preview import contact_sheet, open_for_preview, spread
from panokit.dataset.storage.index import read_index
from panokit.dataset.storage.read import StereoDataset
from panokit.errors import StorageError
from tests.dataset.conftest import COUNT
from tests.dataset.fake import FakeMaker


@pytest.fixture(scope="module")
def card(finished_dataset):
    return (finished_dataset / "README.md").read_text(encoding="utf-8")


def table_rows(text, header):
    """The rows of the Markdown table whose header begins so."""
    lines = text.splitlines()
    first = next(number for number, line in enumerate(lines) if line.startswith(f"| {header}"))
    rows = []
    for line in lines[first + 2 :]:
        if not line.startswith("|"):
            break
        rows.append([cell.strip() for cell in line.strip("|").split("|")])
    return rows


def test_the_card_counts_what_is_there(card):
    made = [FakeMaker().make(index, 0).meta for index in range(COUNT)]
    for split, samples, places, maps, objects in table_rows(card, "split"):
        mine = [meta for meta in made if meta["split"] == split]
        assert int(samples) == len(mine)
        assert int(places) == len({meta["probe"]["place"] for meta in mine})
        assert int(maps) == len({meta["probe"]["id"] for meta in mine})
        assert int(objects) == len({meta["object"]["id"] for meta in mine})
    kinds = {name: int(n) for name, n, _ in table_rows(card, "kind of map")}
    assert kinds == {
        kind: sum(meta["probe"]["kind"] == kind for meta in made) for kind in ("native", "lifted")
    }
    members = [row[0] for row in table_rows(card, "member")]
    assert members[0] == "`left.png`"
    assert len(members) == len(FakeMaker().make(0, 0).members)


def test_it_shows_settings_and_versions(card):
    settings = re.search(r"```toml\n(.*?)```", card, re.DOTALL).group(1)
    import tomllib

    from panokit.dataset.settings import DatasetSettings

    again = DatasetSettings.model_validate(tomllib.loads(settings))
    assert again == FakeMaker().settings
    assert ["renderer name", "fake"] in table_rows(card, "with")
    assert [row[0] for row in table_rows(card, "with")][2:4] == ["package panokit", "package numpy"]


def test_credits_are_where_the_samples_are(finished_dataset, card):
    credits = (finished_dataset / "ATTRIBUTION.md").read_text(encoding="utf-8")
    used = {row["probe_attribution"] for row in read_index(finished_dataset).to_pylist()}
    assert used
    assert all(name in credits for name in used)
    # What panokit made itself needs no credit.
    assert "chair" not in credits
    assert table_rows(card, "of")[0][:2] == ["maps", "CC-BY-4.0"]


def test_what_is_missing_is_said(finished_dataset):
    table = read_index(finished_dataset)
    text = card_text(finished_dataset, table.slice(0, COUNT - 3))
    assert f"3 of the {COUNT} samples that were asked for are not there" in text.replace("\n", " ")


def test_a_sheet_shows_the_samples(finished_dataset):
    dataset = StereoDataset(finished_dataset, members=())
    sheet = contact_sheet(dataset, [0, 5, 9])
    assert sheet.dtype == np.uint8
    assert sheet.shape == (20 + 3 * 132, 4 * 5 + 128 * 3 + 256 + 128 + 4, 3)
    # The first cell of the second row is that sample's left view, enlarged.
    left = dataset.decoded(5, "left.png").repeat(8, 0).repeat(8, 1)
    np.testing.assert_array_equal(sheet[20 + 132 : 20 + 132 + 128, 4 : 4 + 128], left)
    # A normal toward the camera is light blue, whatever is behind the object is white.
    cell = sheet[20 : 20 + 128, 4 + 2 * 132 : 4 + 2 * 132 + 128]
    assert cell[0, 0].tolist() == [255, 255, 255]
    assert cell[64, 64].tolist() == pytest.approx([128, 128, 254], abs=12)


def test_the_sheet_and_the_histograms_are_pictures(finished_dataset):
    for name in ("sheet.jpg", "histograms.png"):
        with Image.open(finished_dataset / name) as picture:
            picture.load()
            assert min(picture.size) > 300
            assert np.asarray(picture).std() > 10


def test_samples_are_spread_over_the_dataset():
    assert spread(100, 3) == [0, 50, 99]
    assert spread(2, 8) == [0, 1]
    assert spread(1, 1) == [0]


def test_a_dataset_under_way_can_be_looked_at(own_dataset, tmp_path):
    (own_dataset / "index.parquet").unlink()
    (own_dataset / "shards" / "train-00001.json").unlink()
    assert len(open_for_preview(own_dataset)) == COUNT - 8
    assert len(open_for_preview(own_dataset, "test")) > 0
    with pytest.raises(StorageError, match="no samples"):
        open_for_preview(tmp_path)
