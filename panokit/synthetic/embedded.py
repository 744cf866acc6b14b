"""The city that travels with panokit: panoramas to fetch, and the truth that only a judge reads.

sample_city/index.json            the captures
sample_city/panoramas/NAME.jpg    what street cameras saw
sample_city/truth/NAME.exr        the radiance, level, in units of the clip level
"""

from collections.abc import Sequence
from pathlib import Path

from panokit.synthetic.folder import read_captures
from panokit.synthetic.pictures import ServedPicture

_FOLDER = Path(__file__).parent / "sample_city"


def embedded_city() -> Sequence[ServedPicture]:
    """The panoramas of the embedded city, ready to be served."""
    return read_captures(_FOLDER / "index.json", _FOLDER / "panoramas", "panokit-sample-city")


def embedded_truth() -> Path:
    """The folder of true radiance maps, NAME.exr for the picture whose id is NAME.

    For judging only: no stage that is judged may read it.
    """
    return _FOLDER / "truth"
