"""Stereo pairs of unknown objects in known light: scenes, rendering, shards, splits, reading.

settings          what is made
stock             what samples are drawn from: `lights`, `objects`; each in one of `splits`
plan, make        a sample's number -> what is drawn for it -> its finished files
scene, rig        what is rendered, and from where; `materials`, what objects are made of
photograph        the picture that a camera makes of it
renderers         Mitsuba, Cycles, and formulas for tests
production        all samples in several processes
storage           shards, index, reading, checks
cards             what is in a dataset, for people
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.dataset.cards.preview import contact_sheet
    from panokit.dataset.make import make_sample
    from panokit.dataset.plan import draw_plan
    from panokit.dataset.production.library_maker import LibraryMaker, open_maker
    from panokit.dataset.production.produce import RenderResult, render_dataset
    from panokit.dataset.production.settings import ProductionSettings
    from panokit.dataset.renderers import make_renderer
    from panokit.dataset.settings import DatasetSettings
    from panokit.dataset.stock import open_stock
    from panokit.dataset.storage.decode import decode_member
    from panokit.dataset.storage.index import read_index
    from panokit.dataset.storage.read import StereoDataset
    from panokit.dataset.storage.sampling import ShardSampler
    from panokit.dataset.storage.verify import verify_dataset

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "DatasetSettings": "panokit.dataset.settings",
        "LibraryMaker": "panokit.dataset.production.library_maker",
        "ProductionSettings": "panokit.dataset.production.settings",
        "RenderResult": "panokit.dataset.production.produce",
        "ShardSampler": "panokit.dataset.storage.sampling",
        "StereoDataset": "panokit.dataset.storage.read",
        "contact_sheet": "panokit.dataset.cards.preview",
        "decode_member": "panokit.dataset.storage.decode",
        "draw_plan": "panokit.dataset.plan",
        "make_renderer": "panokit.dataset.renderers",
        "make_sample": "panokit.dataset.make",
        "open_maker": "panokit.dataset.production.library_maker",
        "open_stock": "panokit.dataset.stock",
        "read_index": "panokit.dataset.storage.index",
        "render_dataset": "panokit.dataset.production.produce",
        "verify_dataset": "panokit.dataset.storage.verify",
    },
)
