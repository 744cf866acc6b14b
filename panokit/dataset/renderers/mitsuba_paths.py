"""Paths through the pixels that can see the object, and through no others.

Most pixels of a picture of one object are empty. Where Mitsuba works on whole arrays (LLVM,
CUDA) paths are traced only through pixels that some triangle's box touches, which is a fifth
of the work saved; the scalar variant renders its film as usual.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.dataset.renderers.mitsuba_scene import Camera, in_line
from panokit.dataset.scene import Mesh, View
from panokit.renderer import evaluate_together, load_mitsuba

Picture = NDArray[np.float32]


def touched_pixels(mesh: Mesh, view: View) -> NDArray[np.bool_]:
    """Pixels that the bounding box of a triangle touches, (H, W): all that can see the object.

    A box adds one at two of its corners and takes one away at the other two; the sums over
    rows and columns then count the boxes at each pixel.
    """
    height, width = view.height_px, view.width_px
    column, row, _ = view.project(mesh.vertices.astype(np.float64))
    corners = np.stack([column, row], axis=1)[mesh.faces]
    low = np.clip(np.floor(corners.min(axis=1)), 0, [width, height]).astype(np.int64)
    high = np.clip(np.floor(corners.max(axis=1)) + 1, 0, [width, height]).astype(np.int64)
    steps = np.zeros((height + 1) * (width + 1), np.int64)
    for (x, y), sign in (
        ((low[:, 0], low[:, 1]), 1),
        ((high[:, 0], high[:, 1]), 1),
        ((low[:, 0], high[:, 1]), -1),
        ((high[:, 0], low[:, 1]), -1),
    ):
        steps += sign * np.bincount(y * (width + 1) + x, minlength=len(steps))
    counts = steps.reshape(height + 1, width + 1).cumsum(axis=0).cumsum(axis=1)
    return counts[:height, :width] > 0


def trace(
    scene: Any, camera: Camera, integrator: Any, samples: int, seed: int, where: NDArray[np.bool_]
) -> Picture:
    """Premultiplied radiance and coverage, (H, W, 4) float32, zero outside `where`.

    Args:
        scene: A Mitsuba scene.
        camera: Aimed already.
        integrator: For the paths; it hides what is straight behind.
        samples: Paths through each pixel.
        seed: The same gives the same picture.
        where: (H, W), the pixels to trace.
    """
    mitsuba = load_mitsuba()
    if mitsuba.variant().startswith("scalar"):
        picture = mitsuba.render(
            scene, sensor=camera.sensor, integrator=integrator, spp=samples, seed=seed
        )
        return np.array(picture, np.float32)
    height, width = where.shape
    pixels = np.flatnonzero(where.ravel())
    result = np.zeros((height * width, 4), np.float32)
    if not len(pixels):
        return result.reshape(height, width, 4)
    sampler = camera.sensor.sampler()
    sampler.set_sample_count(samples)
    samples = int(sampler.sample_count())
    sampler.set_samples_per_wavefront(samples)
    # What is handed over as an array is no part of the compiled kernel; a number would be.
    sampler.seed(mitsuba.UInt32(in_line(np.array([seed], np.uint32))), len(pixels) * samples)
    # Repeated as small numbers, one after the other: these are the largest arrays there are.
    column, row = (
        mitsuba.Float(in_line(np.repeat(index.astype(np.float32), samples)))
        for index in (pixels % width, pixels // width)
    )
    place = mitsuba.Vector2f(column, row) + sampler.next_2d()
    ray, _ = camera.sensor.sample_ray(
        0.0, 0.5, place * mitsuba.Vector2f(1 / width, 1 / height), mitsuba.Point2f(0.5)
    )
    light, hit, _ = integrator.sample(scene, sampler, mitsuba.RayDifferential3f(ray))
    channels = [light.x, light.y, light.z, mitsuba.Float(hit)]
    # One after the other they would be computed four times.
    evaluate_together(channels)
    for index, channel in enumerate(channels):
        paths = np.array(channel).reshape(-1, samples)
        result[pixels, index] = paths.mean(axis=1, dtype=np.float64)
    return result.reshape(height, width, 4)
