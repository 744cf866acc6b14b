import pytest

from panokit.evaluate.lighting.sample import sample_of
from tests.dataset.tiny import tiny_members


@pytest.fixture(scope="session")
def samples(tmp_path_factory):
    """Six samples of vases in sunlight."""
    members = tiny_members(tmp_path_factory.mktemp("maps"), 6, places=6, width_px=48)
    return [sample_of(files) for files in members]
