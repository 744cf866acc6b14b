"""Views of an object in, the light of its scene out.

video            frames of a video or a folder, read when asked for
select           a click becomes an object
track            the object followed, every loss told
pair             from a click to two snapshots
snapshots, crop, background   two snapshots become the views that a network knows
model            a released network, from two views to an estimate
estimate         what is read: the map, how sure it is, what to mind
assumptions      whether two views are what a network was trained for
confidence       how far off an estimate is likely to be, direction by direction
representations  the same light as lat-long map, lights, Gaussians, harmonics
fuse             several estimates as one
outputs          everything as files
session          the whole way, from clicks to files
running          an estimate kept up over a video
clip             the clip that comes with panokit
settings         of all that
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.lighting.assumptions import view_warnings as view_warnings
    from panokit.lighting.clip import clip_path as clip_path
    from panokit.lighting.confidence import Confidence as Confidence
    from panokit.lighting.estimate import LightEstimate as LightEstimate
    from panokit.lighting.fuse import fuse_estimates as fuse_estimates
    from panokit.lighting.model import LightingModel as LightingModel
    from panokit.lighting.outputs import read_outputs as read_outputs
    from panokit.lighting.outputs import write_outputs as write_outputs
    from panokit.lighting.pair import Click as Click
    from panokit.lighting.pair import find_pair as find_pair
    from panokit.lighting.pair import pair_of as pair_of
    from panokit.lighting.running import RunningLight as RunningLight
    from panokit.lighting.running import running_light as running_light
    from panokit.lighting.select import Box as Box
    from panokit.lighting.select import Selection as Selection
    from panokit.lighting.select import flood as flood
    from panokit.lighting.select import select_object as select_object
    from panokit.lighting.select import selection_from_mask as selection_from_mask
    from panokit.lighting.session import light_from_video as light_from_video
    from panokit.lighting.session import read_light as read_light
    from panokit.lighting.session import write_session as write_session
    from panokit.lighting.settings import EstimateSettings as EstimateSettings
    from panokit.lighting.settings import OutputSettings as OutputSettings
    from panokit.lighting.settings import SessionSettings as SessionSettings
    from panokit.lighting.snapshots import Snapshot as Snapshot
    from panokit.lighting.snapshots import StereoPair as StereoPair
    from panokit.lighting.snapshots import stereo_pair as stereo_pair
    from panokit.lighting.track import Track as Track
    from panokit.lighting.track import follow as follow
    from panokit.lighting.track import track_object as track_object
    from panokit.lighting.video import open_frames as open_frames

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "Box": "panokit.lighting.select",
        "Click": "panokit.lighting.pair",
        "Confidence": "panokit.lighting.confidence",
        "EstimateSettings": "panokit.lighting.settings",
        "LightEstimate": "panokit.lighting.estimate",
        "LightingModel": "panokit.lighting.model",
        "OutputSettings": "panokit.lighting.settings",
        "RunningLight": "panokit.lighting.running",
        "Selection": "panokit.lighting.select",
        "SessionSettings": "panokit.lighting.settings",
        "Snapshot": "panokit.lighting.snapshots",
        "StereoPair": "panokit.lighting.snapshots",
        "Track": "panokit.lighting.track",
        "clip_path": "panokit.lighting.clip",
        "find_pair": "panokit.lighting.pair",
        "flood": "panokit.lighting.select",
        "follow": "panokit.lighting.track",
        "fuse_estimates": "panokit.lighting.fuse",
        "light_from_video": "panokit.lighting.session",
        "open_frames": "panokit.lighting.video",
        "pair_of": "panokit.lighting.pair",
        "read_light": "panokit.lighting.session",
        "read_outputs": "panokit.lighting.outputs",
        "running_light": "panokit.lighting.running",
        "select_object": "panokit.lighting.select",
        "selection_from_mask": "panokit.lighting.select",
        "stereo_pair": "panokit.lighting.snapshots",
        "track_object": "panokit.lighting.track",
        "view_warnings": "panokit.lighting.assumptions",
        "write_outputs": "panokit.lighting.outputs",
        "write_session": "panokit.lighting.session",
    },
)
