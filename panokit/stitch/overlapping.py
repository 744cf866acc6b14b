"""Captures and files of overlapping pictures to one result: a panorama, or radiance."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.capture import View
from panokit.envmap import Anchor, EnvironmentMap
from panokit.equirectangular import check_equirectangular
from panokit.errors import ImageError
from panokit.frames import Frame
from panokit.io.captures import StoredCapture
from panokit.io.exr import read_exr
from panokit.io.images import decode_image
from panokit.io.radiance import read_radiance
from panokit.panorama import Panorama
from panokit.provenance import Provenance, Step, digest_of
from panokit.stitch.brackets import merge_brackets
from panokit.stitch.level import leveling_from, turn
from panokit.stitch.matching import match_photos
from panokit.stitch.overlaps import Picture
from panokit.stitch.settings import VERSION, StitchSettings
from panokit.stitch.view_files import ViewEntry, ViewSet, posed_view
from panokit.stitch.views import StitchedViews, stitch_views, width_for_views

_HDR = (".exr", ".hdr")


def stitch_stored_views(stored: StoredCapture, settings: StitchSettings) -> Panorama:
    """The panorama of a fetched capture that is overlapping views.

    Raises:
        ImageError: If a view is damaged or not of the size that the record says, or the views
            contradict each other.
    """
    pictures = [
        decode_image(stored.read(view.name), what=str(stored.folder / view.name))
        for view in stored.views
    ]
    width_px = width_for_views(stored.views, settings.width_px)
    made = stitch_views(pictures, stored.views, width_px, settings)
    pixels = np.asarray(made.pixels, np.uint8)
    valid = made.valid
    leveling: dict[str, Any] = {"leveled": True, "upright_from": "metadata"}
    vehicle = stored.capture.details.get("pitch_reference") == "vehicle"
    if settings.level and settings.upright != "metadata" and vehicle:
        # North is at the center already; what stands upright in the picture says the rest.
        unknown = replace(stored.capture, heading_deg=0.0, pitch_deg=None, roll_deg=None)
        plan = leveling_from(unknown, pixels, settings.upright)
        pixels, valid = turn(pixels, valid, plan.target_from_camera)
        leveling = plan.to_json()
    inputs = (digest_of(stored.capture.to_json()), digest_of(dict(stored.files)))
    return Panorama(
        pixels=pixels,
        capture=stored.capture,
        frame=Frame.WORLD,
        valid=valid,
        provenance=_provenance(settings, inputs, {**made.values, **leveling, "frame": "world"}),
    )


def stitch_view_set(
    views: ViewSet, settings: StitchSettings | None = None
) -> Panorama | EnvironmentMap:
    """What a VIEWS.json describes: a panorama, or an environment map of brackets and HDR views.

    Raises:
        ImageError: If a picture is damaged, the photos do not match, or the views contradict
            each other.
        RecordError, StorageError: If a file is missing.
    """
    settings = settings or StitchSettings()
    digests = views.digests()
    inputs = (digest_of(views.capture.to_json()), digest_of(digests))
    found: dict[str, Any] = {}
    pictures = [_picture(views, entry, found) for entry in views.entries]
    if views.whole:
        return _whole(views, pictures[0], found, settings, inputs)
    if views.entries[0].pose is not None:
        placed: Sequence[View] = [
            posed_view(entry, picture.shape[1], picture.shape[0])
            for entry, picture in zip(views.entries, pictures, strict=True)
        ]
        frame = Frame.WORLD
    else:
        matched = match_photos([_display(p) for p in pictures],
                               [entry.shots[0].name for entry in views.entries])  # fmt: skip
        placed, frame = matched.views, Frame.CAMERA
        pictures = [pictures[i] for i in matched.kept]
        found["left_out"] = list(matched.left_out)
        found["poses"] = [
            {name: round(getattr(view, name), 3)
             for name in ("heading_deg", "pitch_deg", "roll_deg", "fov_deg")}
            for view in placed
        ]  # fmt: skip
    made = stitch_views(pictures, placed, width_for_views(placed, settings.width_px), settings)
    return _result(views, made, frame, {**found, **made.values}, settings, inputs)


def _result(
    views: ViewSet,
    made: StitchedViews,
    frame: Frame,
    found: dict[str, Any],
    settings: StitchSettings,
    inputs: tuple[str, ...],
) -> Panorama | EnvironmentMap:
    provenance = _provenance(settings, inputs, {**found, "frame": str(frame)})
    if made.pixels.dtype == np.float32:
        if made.valid is not None:
            raise ImageError(
                f"The views cover {made.values['coverage']:.1%} of the sphere, and an environment "
                "map has no holes. Add the views that are missing, or use "
                "panokit.stitch.stitch_views, which returns the mask of what is covered.",
                reason="not-covered",
                values={"coverage": made.values["coverage"]},
            )
        return EnvironmentMap(
            radiance=np.asarray(made.pixels, np.float32),
            frame=frame,
            anchor=Anchor.LDR_WHITE if views.is_bracketed else Anchor.RELATIVE,
            capture=views.capture,
            provenance=provenance,
        )
    return Panorama(
        pixels=np.asarray(made.pixels, np.uint8),
        capture=views.capture,
        frame=frame,
        valid=made.valid,
        provenance=provenance,
    )


def _whole(
    views: ViewSet,
    picture: Picture,
    found: dict[str, Any],
    settings: StitchSettings,
    inputs: tuple[str, ...],
) -> EnvironmentMap:
    check_equirectangular(picture)
    return EnvironmentMap(
        radiance=np.asarray(picture, np.float32),
        frame=Frame.CAMERA,
        anchor=Anchor.LDR_WHITE,
        capture=views.capture,
        provenance=_provenance(settings, inputs, {**found, "frame": "camera"}),
    )


def _picture(views: ViewSet, entry: ViewEntry, found: dict[str, Any]) -> Picture:
    if len(entry.shots) == 1 and not views.is_bracketed:
        return _read(views, entry.shots[0].name)
    shots = [np.asarray(_read(views, shot.name), np.uint8) for shot in entry.shots]
    exposures = [shot.exposure or 0.0 for shot in entry.shots]
    curve: Any = views.curve
    merged = merge_brackets(shots, exposures, curve=curve)
    found.setdefault("brackets", []).append(merged.values)
    # Each is in units of its own reference; all are brought to that of the first view.
    first = found["brackets"][0]["reference_exposure"]
    scale = first / merged.values["reference_exposure"]
    return np.asarray(merged.radiance * np.float32(scale), np.float32)


def _read(views: ViewSet, name: str) -> Picture:
    path = views.folder / name
    if Path(name).suffix.lower() == ".exr":
        return read_exr(path)[0]
    if Path(name).suffix.lower() == ".hdr":
        return read_radiance(path)
    return decode_image(views.read(name), what=str(path))


def _display(picture: Picture) -> NDArray[np.uint8]:
    """A picture for finding features in."""
    if picture.dtype == np.uint8:
        return np.asarray(picture)
    top = float(np.percentile(picture, 98))
    if not top > 0:
        raise ImageError("A view is black; nothing can be matched in it.", reason="black-map")
    coded = np.power(np.clip(picture / top, 0, 1), 1 / 2.2)
    return np.rint(coded * 255).astype(np.uint8)


def _provenance(
    settings: StitchSettings, inputs: tuple[str, ...], values: dict[str, Any]
) -> Provenance:
    return Provenance(
        (
            Step(
                stage="stitch",
                version=VERSION,
                settings_digest=settings.digest,
                input_digests=inputs,
                values=values,
            ),
        )
    )
