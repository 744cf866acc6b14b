"""Adapters to perceptual metrics that are programs of their own: HDR-VDP-3 and ColorVideoVDP.

Both predict what an observer sees on a display, so both want absolute luminance, a display and a
distance; and both are made for flat pictures. A lat-long picture as it is would be judged as if
its stretched poles hung on the wall. So a map is cut into pinhole views first, and its relative
radiance gets a unit: the level at which the camera's picture clipped is `white_cd_m2`.

HDR-VDP-3 (Mantiuk, Hammou and Hanji 2023) is MATLAB code and cannot be called from here:
`absolute_views` prepares its inputs. ColorVideoVDP (Mantiuk et al. 2024) is a Python package on
PyTorch, `pip install cvvdp`; `colorvideovdp_jod` calls it if it is there.
"""

from dataclasses import dataclass
from importlib import import_module

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.frames import Rotation
from panokit.metrics.pairs import Radiance, radiance_pair
from panokit.metrics.pu21 import CLIP_LEVEL_CD_M2
from panokit.sphere.reproject import perspective_view

SIDES_DEG = (0.0, 90.0, 180.0, 270.0)
_INCH_M = 0.0254


@dataclass(frozen=True, slots=True, kw_only=True)
class Viewing:
    """A display and where the observer is; the defaults are HDR-VDP-3's published setting.

    Attributes:
        diagonal_in: Of the display, in inches.
        width_px: Of the display.
        height_px: Of the display.
        distance_m: From the eye to the display.
    """

    diagonal_in: float = 24.0
    width_px: int = 1920
    height_px: int = 1080
    distance_m: float = 1.0

    def __post_init__(self) -> None:
        if min(self.diagonal_in, self.width_px, self.height_px, self.distance_m) <= 0:
            raise UsageError("A display has a size, a resolution and a distance above zero.")

    @property
    def pixels_per_degree(self) -> float:
        """Rows over the angle that the display's height fills, as hdrvdp_pix_per_deg has it."""
        aspect = self.width_px / self.height_px
        height_m = self.diagonal_in * _INCH_M / np.sqrt(1 + aspect**2)
        return self.height_px / float(np.degrees(2 * np.arctan(height_m / 2 / self.distance_m)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AbsoluteViews:
    """The same views of two maps, in absolute units.

    Attributes:
        test: (n, size, size, 3) float32, linear Rec.709 in cd/m2, of the estimate.
        reference: The same of the truth.
        pixels_per_degree: As the observer sees them.
    """

    test: NDArray[np.float32]
    reference: NDArray[np.float32]
    pixels_per_degree: float


@dataclass(frozen=True, slots=True, kw_only=True)
class JodScore:
    """A quality in just-objectionable differences.

    Attributes:
        jod: 10 is no visible difference; one less is one step that 75 % of observers notice.
        settings: What the metric says of its version and display; quote it with the score.
    """

    jod: float
    settings: str


def absolute_views(
    estimate: Radiance,
    truth: Radiance,
    *,
    white_cd_m2: float = CLIP_LEVEL_CD_M2,
    size_px: int = 512,
    fov_deg: float = 90.0,
    viewing: Viewing | None = None,
) -> AbsoluteViews:
    """Four level views of both maps, to the front, right, back and left.

    For HDR-VDP-3, write each pair to EXR and call, in MATLAB or Octave,
    `hdrvdp3('quality', test, reference, 'rgb-bt.709', pixels_per_degree)`; its Q_JOD is the
    score, and the mean over views that of the map.

    Args:
        estimate: (H, W, 3), linear, on the truth's scale, in units of the clip level.
        truth: As `estimate`.
        white_cd_m2: The luminance that 1.0 stands for.
        size_px: Width and height of a view.
        fov_deg: Of a view.
        viewing: The display; HDR-VDP-3's published setting if not given.

    Raises:
        UsageError: If the shapes differ or the luminance of white is not above zero.
    """
    radiance_pair(estimate, truth)
    if not white_cd_m2 > 0:
        raise UsageError(f"White has a luminance above zero, not {white_cd_m2} cd/m2.")
    poses = [Rotation.from_heading_pitch_roll(float(np.deg2rad(side))) for side in SIDES_DEG]
    test, reference = (
        np.stack(
            [
                perspective_view(np.asarray(radiance, np.float32), size_px, size_px, fov_deg, pose)
                for pose in poses
            ]
        )
        * np.float32(white_cd_m2)
        for radiance in (estimate, truth)
    )
    return AbsoluteViews(
        test=test,
        reference=reference,
        pixels_per_degree=(viewing or Viewing()).pixels_per_degree,
    )


def colorvideovdp_jod(views: AbsoluteViews, *, display: str = "standard_hdr_linear") -> JodScore:
    """The quality of the estimate by ColorVideoVDP, the mean over views.

    Args:
        views: From `absolute_views`.
        display: One of ColorVideoVDP's displays that take linear cd/m2; it brings its own
            resolution and distance.

    Raises:
        UsageError: If the package is not installed.
    """
    try:
        package = import_module("pycvvdp")
    except ImportError as error:
        raise UsageError(
            "ColorVideoVDP needs the package 'pycvvdp', which is not installed. Install it with: "
            "pip install cvvdp"
        ) from error
    metric = package.cvvdp(display_name=display)
    scores = [
        float(metric.predict(test, reference, dim_order="HWC")[0])
        for test, reference in zip(views.test, views.reference, strict=True)
    ]
    return JodScore(jod=float(np.mean(scores)), settings=str(metric.get_info_string()))
