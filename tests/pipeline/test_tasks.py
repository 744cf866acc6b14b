import numpy as np
import pytest

from panokit.expand.settings import ExpandSettings
from panokit.io import encode_jpeg, write_bytes
from panokit.pipeline import tasks
from panokit.pipeline.tasks import StageTask, run_task
from panokit.records import Receipt


def test_an_item_that_has_its_record_is_not_made_again(tmp_path, monkeypatch):
    # As when a worker is killed between writing the record and saying so.
    street = np.tile(np.linspace(20, 255, 256, dtype=np.uint8)[None, :, None], (128, 1, 3))
    write_bytes(tmp_path / "street.jpg", encode_jpeg(street))
    task = StageTask(
        stage="expand",
        item="street",
        source=tmp_path / "street.jpg",
        target=tmp_path / "street.exr",
        settings=ExpandSettings(model="srgb", width_px=256),
    )
    first = run_task(task)
    assert isinstance(first, Receipt)

    def fail(*_):
        pytest.fail("it was made again")

    monkeypatch.setitem(tasks._WORK, "expand", fail)
    second = run_task(task)
    assert isinstance(second, Receipt)
    assert (second.key, second.path) == (first.key, first.path)
    (tmp_path / "street.json").unlink()
    with pytest.raises(pytest.fail.Exception, match="made again"):
        run_task(task)
