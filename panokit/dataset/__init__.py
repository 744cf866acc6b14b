"""Stereo pairs of unknown objects in known light: scenes, rendering, shards, splits, reading.

settings, production      what is made, and how
stock                     what samples are drawn from: `lights`, `objects`; each in one of `splits`
plan, make                a sample's number -> what is drawn for it -> its finished files
scene, rig, renderers     what is rendered, from where, by what
photograph, members       the pictures a camera makes of it, as files
produce                   all samples in several processes: `attempts`, `shard_task`, `spool`,
                          `losses`, `progress`; `repeat` for one alone, `estimate` for none
shards, layout, index     what lies where
card, preview, verify     what is in a dataset, for people, and whether it is whole
read, sampling, decode    random access, orders of reading, files -> arrays
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.dataset.decode import decode_member
    from panokit.dataset.index import read_index
    from panokit.dataset.library_maker import LibraryMaker, open_maker
    from panokit.dataset.make import make_sample
    from panokit.dataset.plan import draw_plan
    from panokit.dataset.preview import contact_sheet
    from panokit.dataset.produce import RenderResult, render_dataset
    from panokit.dataset.production import ProductionSettings
    from panokit.dataset.read import StereoDataset
    from panokit.dataset.renderers import make_renderer
    from panokit.dataset.sampling import ShardSampler
    from panokit.dataset.settings import DatasetSettings
    from panokit.dataset.stock import open_stock
    from panokit.dataset.verify import verify_dataset

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "DatasetSettings": "panokit.dataset.settings",
        "LibraryMaker": "panokit.dataset.library_maker",
        "ProductionSettings": "panokit.dataset.production",
        "RenderResult": "panokit.dataset.produce",
        "ShardSampler": "panokit.dataset.sampling",
        "StereoDataset": "panokit.dataset.read",
        "contact_sheet": "panokit.dataset.preview",
        "decode_member": "panokit.dataset.decode",
        "draw_plan": "panokit.dataset.plan",
        "make_renderer": "panokit.dataset.renderers",
        "make_sample": "panokit.dataset.make",
        "open_maker": "panokit.dataset.library_maker",
        "open_stock": "panokit.dataset.stock",
        "read_index": "panokit.dataset.index",
        "render_dataset": "panokit.dataset.produce",
        "verify_dataset": "panokit.dataset.verify",
    },
)
