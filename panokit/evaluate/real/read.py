"""A published data set in, stereo samples out."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import srgb_encode_u8
from panokit.dataset.photograph import metered_exposure
from panokit.errors import ImageError, Rejection, UsageError
from panokit.evaluate.lighting.sample import StereoSample, level_from_camera
from panokit.evaluate.real.objects_with_lighting import scenes_of as objects_with_lighting
from panokit.evaluate.real.pairs import RealPair, find_pairs
from panokit.evaluate.real.rectify import Cutout, Rig, cut_out, rig_of
from panokit.evaluate.real.scenes import MeasuredLight, RealScene
from panokit.evaluate.real.settings import PairSettings
from panokit.evaluate.real.stanford_orb import scenes_of as stanford_orb
from panokit.frames import Rotation
from panokit.sphere import resize_radiance, rotate_radiance
from panokit.stereo import Views

SCHEMA = "panokit.real-pair/1"
TARGET_PX, _LIGHT_PX = 64, 256
# Cut-outs whose pictures are black beside the object were published without a background.
_BLACK = 1e-4
KINDS: Mapping[str, Callable[[Path], Iterator[RealScene]]] = {
    "stanford-orb": stanford_orb,
    "objects-with-lighting": objects_with_lighting,
}


def read_pairs(
    folder: Path,
    kind: str,
    settings: PairSettings | None = None,
    *,
    on_reject: Callable[[Rejection], None] | None = None,
) -> Iterator[StereoSample]:
    """Pairs of photographs nearly side by side, with the light that was measured there.

    A pair whose object cannot be cut out is a rejection. `meta` says of each what it was made from,
    whether its light has the scale of its pictures (`scale_known`), and of the background whether
    it is "filled" behind the object or "unknown".

    Args:
        folder: As published.
        kind: "stanford-orb" or "objects-with-lighting".
        settings: Which pairs, and how large.
        on_reject: Told of each pair that cannot be used.

    Yields:
        Samples, numbered from 0; normals are 0 where the data set has none.

    Raises:
        UsageError: If the kind is not known, or the folder holds no such data.
    """
    if kind not in KINDS:
        raise UsageError(f"There is no data set {kind!r}; choose from {', '.join(KINDS)}.")
    settings = settings or PairSettings()
    number = 0
    for scene in KINDS[kind](Path(folder)):
        for pair in find_pairs(scene, settings):
            try:
                yield sample_of_pair(scene, pair, settings, number, kind)
            except ImageError as error:
                if on_reject is not None:
                    item = f"{scene.object}/{scene.place}/{pair.left.name}"
                    on_reject(Rejection.from_error(item, "pairs", error))
                continue
            number += 1


def sample_of_pair(
    scene: RealScene, pair: RealPair, settings: PairSettings, number: int, kind: str
) -> StereoSample:
    """One pair as a sample.

    Raises:
        ImageError: If the object cannot be cut out of both photographs.
    """
    pictures = pair.left.read(), pair.right.read()
    rig = rig_of(pair, scene.center, (pictures[0][1], pictures[1][1]), settings)
    left, right = (
        cut_out(view, *picture, turn, rig.fov_deg, settings.width_px)
        for view, picture, turn in zip(
            (pair.left, pair.right), pictures, (rig.left, rig.right), strict=True
        )
    )
    exposure = metered_exposure(left.radiance, left.coverage) if scene.metered else 1.0
    light = scene.light_near(pair.left)
    background, told = _background(left, exposure)
    mask = left.coverage > 0.5
    level = level_from_camera(rig.left) if scene.upright else Rotation.identity()
    baseline = float(np.linalg.norm(pair.right.position - pair.left.position))
    return StereoSample(
        key=f"{number:09d}",
        views=Views(
            left=_encoded(left.radiance, exposure),
            right=_encoded(right.radiance, exposure),
            left_object=_encoded(left.radiance * left.coverage[..., None], exposure),
            right_object=_encoded(right.radiance * right.coverage[..., None], exposure),
            mask=mask,
            background=background,
            normals=left.normals * mask[..., None],
            parts=mask.astype(np.uint8),
            fov_deg=rig.fov_deg,
            baseline_m=baseline,
            left_level=level,
        ),
        truth=_truth(light, rig.left) * np.float32(exposure),
        meta=_meta(scene, pair, light, rig, exposure, told, kind)
        | {"key": f"{number:09d}", "baseline_m": baseline},
    )


def _truth(light: MeasuredLight, world_from_camera: Rotation) -> NDArray[np.float32]:
    """The light in a camera's frame, (64, 64, 3); the energy is the map's."""
    radiance = np.maximum(light.read(), 0)
    small = resize_radiance(radiance, min(_LIGHT_PX, radiance.shape[1] // 2 * 2))
    turned = rotate_radiance(small, world_from_camera.inverse @ light.world_from_map)
    if turned.shape[1] < 2 * TARGET_PX:
        turned = resize_radiance(turned, 2 * TARGET_PX)
    return resize_radiance(turned, TARGET_PX, TARGET_PX)


def _background(left: Cutout, exposure: float) -> tuple[NDArray[np.uint8], str]:
    """What is behind the object: the photograph, and where the object hides it, from around."""
    seen = left.known & (left.coverage < 0.02)
    # At the edge of the object a few pixels have a little of it.
    if not seen.any() or float(np.percentile(left.radiance[seen], 95)) < _BLACK:
        return np.zeros((*left.coverage.shape, 3), np.uint8), "unknown"
    # A blur of what is seen over a blur of where: ever wider until every pixel has some.
    filled = np.where(seen[..., None], left.radiance, 0)
    missing = ~seen
    for width in 2.0 ** np.arange(1, 9):
        share = cv2.GaussianBlur(seen.astype(np.float32), (0, 0), width)
        blurred = cv2.GaussianBlur(np.where(seen[..., None], left.radiance, 0), (0, 0), width)
        enough = missing & (share > 0.05)
        filled[enough] = blurred[enough] / share[enough, None]
        missing &= ~enough
        if not missing.any():
            break
    filled[missing] = left.radiance[seen].mean(axis=0)
    return _encoded(filled, exposure), "filled"


def _encoded(radiance: NDArray[np.float32], exposure: float) -> NDArray[np.uint8]:
    return srgb_encode_u8(np.maximum(radiance, 0) * np.float32(exposure))


def _meta(
    scene: RealScene,
    pair: RealPair,
    light: MeasuredLight,
    rig: Rig,
    exposure: float,
    background: str,
    kind: str,
) -> dict[str, Any]:
    def camera(turn: Rotation, position: NDArray[np.float64]) -> dict[str, Any]:
        return {
            "world_from_camera": turn.matrix.tolist(),
            "position_m": position.tolist(),
            "fov_deg": rig.fov_deg,
        }

    return {
        "schema": SCHEMA,
        "source": kind,
        "object": {"id": scene.object},
        "pair": [pair.left.name, pair.right.name],
        "light": light.name,
        "rotation_deg": pair.rotation_deg,
        "off_axis_deg": pair.off_axis_deg,
        "over_depth": pair.over_depth,
        "parallel": rig.left == rig.right,
        "exposure": exposure,
        "scale_known": scene.scale_known,
        "background": background,
        "probe": {
            "id": f"{scene.place}/{light.name}", "place": scene.place, "category": "",
            "kind": "native",
        },
        "views": {
            "left": camera(rig.left, pair.left.position),
            "right": camera(rig.right, pair.right.position),
        },
    }  # fmt: skip
