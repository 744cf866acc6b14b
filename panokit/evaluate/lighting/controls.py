"""Whether a network uses its second view: what happens to its score when the view is spoiled.

A network that reads depth from the pair does worse with the left view in place of the right one,
with the views exchanged or moved against each other, or with the right view of another sample.
One that does not, does not. Networks on reflectance maps have controls of their own: normals
that are off, and materials that are guessed.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from panokit.evaluate.lighting.models import ModelFacts
from panokit.evaluate.lighting.sample import StereoSample
from panokit.reflectance import add_noise, segment_materials

# Takes a sample and all of them, and gives the sample with another right view.
Control = Callable[[StereoSample, Sequence[StereoSample]], StereoSample]


def right_is_left(sample: StereoSample, others: Sequence[StereoSample]) -> StereoSample:
    """The left view twice: no disparity anywhere."""
    views = sample.views
    return replace(sample, views=replace(views, right=views.left, right_object=views.left_object))


def exchanged(sample: StereoSample, others: Sequence[StereoSample]) -> StereoSample:
    """Left and right exchanged: every disparity has the wrong sign."""
    views = sample.views
    return replace(
        sample,
        views=replace(
            views, left=views.right, right=views.left,
            left_object=views.right_object, right_object=views.left_object,
        ),
    )  # fmt: skip


def right_of_another(sample: StereoSample, others: Sequence[StereoSample]) -> StereoSample:
    """The right view of another sample, chosen by the key."""
    first = int(np.random.default_rng([1, int(sample.key)]).integers(len(others)))
    strangers = (others[(first + step) % len(others)] for step in range(len(others)))
    other = next((one.views for one in strangers if one.key != sample.key), sample.views)
    return replace(
        sample,
        views=replace(sample.views, right=other.right, right_object=other.right_object),
    )


def shifted(sample: StereoSample, others: Sequence[StereoSample]) -> StereoSample:
    """The right view moved sideways by a sixteenth: all disparities are wrong by as much."""
    views = sample.views
    return replace(
        sample,
        views=replace(
            views, right=_moved(views.right), right_object=_moved(views.right_object),
        ),
    )  # fmt: skip


def noisy_normals(
    sample: StereoSample, others: Sequence[StereoSample], *, mean_deg: float
) -> StereoSample:
    """Normals that are off, alike for neighbors, as those of the recipes with noise."""
    views = sample.views
    seen = views.mask & (np.abs(views.normals).sum(axis=-1) > 0)
    smooth_px = views.mask.shape[1] / 16
    normals = add_noise(views.normals, seen, mean_deg, smooth_px=smooth_px, seed=int(sample.key))
    return replace(sample, views=replace(views, normals=normals))


def guessed_materials(sample: StereoSample, others: Sequence[StereoSample]) -> StereoSample:
    """Materials by k-means on the picture, not as they are."""
    views = sample.views
    picture = views.left_object / np.float32(255)
    parts = segment_materials(picture, views.mask, 3)
    return replace(sample, views=replace(views, parts=np.asarray(parts, np.uint8)))


def _moved(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    step = picture.shape[1] // 16
    return np.concatenate([picture[:, :1].repeat(step, axis=1), picture[:, :-step]], axis=1)


CONTROLS: Mapping[str, Control] = MappingProxyType(
    {
        "right is left": right_is_left,
        "exchanged": exchanged,
        "right shifted": shifted,
        "right of another": right_of_another,
    }
)
NORMALS: Mapping[float, str] = MappingProxyType(
    {level: f"normals off by {level:g}" for level in (10.0, 20.0, 30.0)}
)
_OF_NORMALS = {name: partial(noisy_normals, mean_deg=level) for level, name in NORMALS.items()}
MATERIALS = "materials by k-means"


def controls_of(facts: ModelFacts) -> Mapping[str, Control]:
    """The controls that tell something of a model."""
    if facts.kind == "stereo":
        return CONTROLS
    if facts.kind == "picture-reflectance" or facts.noise_deg > 0:
        return {}
    return {**_OF_NORMALS, MATERIALS: guessed_materials} if facts.materials > 1 else _OF_NORMALS
