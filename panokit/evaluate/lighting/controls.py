"""Whether a network uses its second view: what happens to its score when the view is spoiled.

A network that reads depth from the pair does worse with the left view in place of the right one,
with the views exchanged, or with the right view of another sample. One that does not, does not.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from panokit.evaluate.lighting.sample import StereoSample

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
    rng = np.random.default_rng([1, int(sample.key)])
    strangers = [other for other in others if other.key != sample.key]
    if not strangers:
        return sample
    other = strangers[int(rng.integers(len(strangers)))].views
    return replace(
        sample,
        views=replace(sample.views, right=other.right, right_object=other.right_object),
    )


CONTROLS: Mapping[str, Control] = {
    "right is left": right_is_left,
    "exchanged": exchanged,
    "right of another": right_of_another,
}
