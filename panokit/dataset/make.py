"""Make a sample: from its plan to finished files.

All linear pictures of a sample have one scale: 1.0 is the white of the pictures. The radiance of
the original map is theirs divided by `exposure` in meta.json.
"""

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.color.transfer import srgb_encode_u8
from panokit.dataset.lights import ALIGNED_WIDTH_PX
from panokit.dataset.photograph import (
    blurred_background,
    check_pictures,
    composite_over,
    metered_exposure,
)
from panokit.dataset.rig import place_rig
from panokit.dataset.sample import SCHEMA, Sample, SamplePlan, sample_key
from panokit.dataset.scene import Mesh, Quality, Renderer, Scene, View, ViewPasses
from panokit.dataset.settings import DatasetSettings
from panokit.dataset.stock import Stock
from panokit.dataset.storage.members import exr_bytes, json_bytes
from panokit.envmap import Anchor, EnvironmentMap
from panokit.errors import ImageError
from panokit.frames import Frame, Rotation
from panokit.io import encode_png
from panokit.sphere import energy, resize_radiance, rotate_radiance
from panokit.sphere.sampling import sample

TARGET_PX = 64
REFLECTANCE_PX = 64
_REFLECTANCE_SAMPLES = 64
_ENERGY_SLACK = 1e-3


def make_sample(
    plan: SamplePlan, settings: DatasetSettings, stock: Stock, renderer: Renderer
) -> Sample:
    """Render a plan and encode its files.

    Raises:
        ImageError: If the sample is not usable: "blank-mask", "not-finite", "over-exposed",
            "under-exposed" or "energy-lost"; or the object or the map is not.
    """
    scene = build_scene(plan, stock)
    left, right = place_rig(
        settings.rig,
        scene.mesh.vertices,
        baseline_m=plan.baseline_m,
        fill=plan.fill,
        pitch_deg=plan.pitch_deg,
        roll_deg=plan.roll_deg,
    )
    quality = Quality(samples=settings.samples, bounces=settings.bounces, denoise=settings.denoise)
    passes = renderer.render(scene, (left, right), quality, plan.render_seed)
    aligned = aligned_light(scene.light, left.world_from_camera)
    reflectance = [
        renderer.reflectance(
            material,
            aligned,
            replace(quality, samples=min(settings.samples, _REFLECTANCE_SAMPLES)),
            plan.render_seed + 1 + number,
            REFLECTANCE_PX,
        )
        for number, material in enumerate(plan.materials)
    ]
    blurred = blurred_background(scene.light.radiance, settings.background_blur_deg)
    backgrounds = [sample(blurred, view.rays()) for view in (left, right)]
    composites = [
        composite_over(one, behind) for one, behind in zip(passes, backgrounds, strict=True)
    ]
    exposure = metered_exposure(composites[0], passes[0].coverage) * 2.0**plan.exposure_stops
    figures = check_pictures(passes, composites, exposure) | _energy_kept(scene, aligned)
    members: dict[str, bytes] = {}
    for view, one, composite in zip((left, right), passes, composites, strict=True):
        members |= _view_members(view.name, one, composite * exposure, exposure, settings.hdr)
        if len(plan.materials) > 1:
            members[f"{view.name}_material.png"] = encode_png(one.part)
    members["background.png"] = encode_png(srgb_encode_u8(backgrounds[0] * exposure))
    if settings.rig.toe_in or settings.rig.translate:
        members["right_background.png"] = encode_png(srgb_encode_u8(backgrounds[1] * exposure))
    if settings.hdr:
        members["albedo.exr"] = exr_bytes(passes[0].albedo, half=True)
    members |= _light_members(aligned.radiance * np.float32(exposure))
    for number, picture in enumerate(reflectance, start=1):
        name = "reflectance.exr" if len(reflectance) == 1 else f"reflectance_{number}.exr"
        members[name] = exr_bytes(picture * np.float32(exposure))
    meta = _meta(plan, settings, stock, renderer.describe(), (left, right), exposure, figures)
    members["meta.json"] = json_bytes(meta)
    return Sample(
        key=sample_key(plan.index),
        split=plan.split,
        members=members,
        meta=meta,
        views=(left, right),
        figures=figures,
    )


def build_scene(plan: SamplePlan, stock: Stock) -> Scene:
    """The object as it stands, in its materials, in the turned light."""
    mesh = stock.objects.load(plan.object_id)
    vertices = Rotation.about_axis((0, 1, 0), float(np.deg2rad(plan.object_turn_deg))).apply(
        mesh.vertices
    )
    placed = Mesh(
        vertices=vertices,
        faces=mesh.faces,
        part=np.asarray(plan.material_of_part, np.uint8)[mesh.part],
        smooth=mesh.smooth,
    )
    source = stock.lights.load(plan.probe_id).radiance
    light = rotate_radiance(source, world_from_map(plan))
    return Scene(
        mesh=placed,
        materials=plan.materials,
        light=EnvironmentMap(radiance=light, frame=Frame.WORLD),
        floor_m=float(vertices[:, 1].min()) if plan.on_floor else None,
    )


def world_from_map(plan: SamplePlan) -> Rotation:
    """How the map is turned and then tilted."""
    yaw = Rotation.about_axis((0, 1, 0), -float(np.deg2rad(plan.yaw_deg)))
    toward = float(np.deg2rad(plan.tilt_toward_deg))
    # The axis lies to the right of where the zenith goes, so that a right-handed turn by a
    # negative angle moves the zenith there.
    axis = (np.cos(toward), 0.0, np.sin(toward))
    return Rotation.about_axis(axis, -float(np.deg2rad(plan.tilt_deg))) @ yaw


def aligned_light(light: EnvironmentMap, world_from_camera: Rotation) -> EnvironmentMap:
    """The map in the camera's frame: the center looks where the camera looks; energy kept."""
    # Made smaller first: turning a map costs as much as it has pixels.
    small = resize_radiance(light.radiance, ALIGNED_WIDTH_PX)
    turned = rotate_radiance(small, world_from_camera.inverse)
    return EnvironmentMap(radiance=turned, frame=Frame.CAMERA)


def _view_members(
    name: str, one: ViewPasses, composite: NDArray[np.float32], exposure: float, hdr: bool
) -> dict[str, bytes]:
    members = {
        f"{name}.png": encode_png(srgb_encode_u8(composite)),
        f"{name}_object.png": encode_png(srgb_encode_u8(one.radiance * np.float32(exposure))),
        f"{name}_mask.png": encode_png(np.rint(one.coverage * 255).astype(np.uint8)),
        f"{name}_normal.exr": exr_bytes(one.normal, half=True),
        f"{name}_depth.exr": exr_bytes(one.depth, half=True),
    }
    if hdr:
        members[f"{name}.exr"] = exr_bytes(composite)
    return members


def _energy_kept(scene: Scene, aligned: EnvironmentMap) -> dict[str, float]:
    """The energy of the aligned map over that of the map it is made from.

    Raises:
        ImageError: If they differ.
    """
    kept = float(energy(aligned.radiance).sum() / energy(scene.light.radiance).sum())
    if abs(kept - 1) > _ENERGY_SLACK:
        raise ImageError(
            f"The aligned map has {kept:.4f} of the map's energy.",
            reason="energy-lost", values={"energy_kept": kept},
        )  # fmt: skip
    return {"energy_kept": kept}


def _light_members(aligned: NDArray[np.float32]) -> dict[str, bytes]:
    target = resize_radiance(aligned, TARGET_PX, TARGET_PX)
    projection = "panokit:projection"
    return {
        "env64.exr": exr_bytes(target, attributes={projection: "equirectangular-anamorphic"}),
        "env.exr": exr_bytes(aligned, attributes={projection: "equirectangular"}),
    }


def _meta(
    plan: SamplePlan,
    settings: DatasetSettings,
    stock: Stock,
    renderer: Mapping[str, Any],
    views: tuple[View, View],
    exposure: float,
    figures: Mapping[str, float],
) -> dict[str, Any]:
    light = stock.lights.all[plan.probe_id]
    drawn = asdict(replace(plan, materials=()))
    drawn.pop("materials")
    return {
        "schema": SCHEMA,
        "key": sample_key(plan.index),
        **drawn,
        "exposure": exposure,
        "materials": [material.to_json() for material in plan.materials],
        "object": asdict(stock.objects.source(plan.object_id))
        | {"sha256": stock.objects.digest(plan.object_id)},
        "probe": {
            "id": light.id,
            "place": light.place,
            "kind": light.kind,
            "category": light.category,
            "license": light.license.id,
            "attribution": light.license.attribution,
            "sha256": light.digest,
        },
        "anchor": str(Anchor.LDR_WHITE),
        "world_from_map": world_from_map(plan).matrix.tolist(),
        "views": {view.name: view.to_json() for view in views},
        "renderer": dict(renderer),
        "samples": settings.samples,
        "figures": dict(figures),
    }
