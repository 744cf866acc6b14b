"""glTF 2.0: a map as an image-based light, in one .glb file.

The extension EXT_lights_image_based keeps a cube map, sharp and for ever rougher surfaces, and
nine numbers for matte ones. A direction keeps its name: glTF has +X, +Y up and +Z as panokit
has them. Faces are those of the specification's text: in the order +X, -X, +Y, -Y, +Z, -Z, each
the OpenGL cube map's, mirrored left to right, which makes them what one sees from inside.

Pixels are RGBD: RGB, encoded with gamma 2.2, is divided by A. That spans 1 : 255 and eight bits
of color; a sun does not fit. What is brighter is taken out, one directional light
(KHR_lights_punctual) for each source, and the energy is the same.
"""

import json
import struct
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance
from panokit.envmap import EnvironmentMap
from panokit.errors import UsageError
from panokit.io.adapters.analytic_sun import AnalyticSun
from panokit.io.adapters.prefilter import prefilter_ggx
from panokit.io.adapters.usd import axes_about
from panokit.sphere import (
    Cubemap,
    Equirectangular,
    energy,
    equirect_directions,
    harmonics_for_tool,
    irradiance_harmonics,
    label_regions,
    project_harmonics,
    reproject,
    resize_radiance,
    row_solid_angles,
    split_faces,
)

LIGHT, PUNCTUAL = "EXT_lights_image_based", "KHR_lights_punctual"
# How panokit's faces lie in the file: up and down are turned by half a turn.
_FACES = (("right", 0), ("left", 0), ("up", 2), ("down", 2), ("back", 0), ("front", 0))
_SMALLEST_PX = 16
_RGBD_TOP = 255.0
_GAMMA = 2.2
# More sources than this are rather told by a darker, coarser cube map.
_MOST_LIGHTS = 8


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Distant:
    """A light that does not fit into the cube map."""

    name: str
    direction: NDArray[np.float64]
    irradiance: NDArray[np.float64]


def gltf_environment(
    envmap: EnvironmentMap, *, name: str, face_px: int = 256, sun: AnalyticSun | None = None
) -> bytes:
    """A .glb file with a map as the light of its one scene.

    Args:
        envmap: The map.
        name: Of the light.
        face_px: The width of a face of the sharpest cube map, a power of two, at least 32.
        sun: The sun beside it, for a map without its sun.

    Raises:
        UsageError: If the faces have no such width.
    """
    if face_px < 2 * _SMALLEST_PX or face_px & (face_px - 1):
        raise UsageError(f"A face is 32, 64, 128, ... pixels wide, not {face_px}.")
    radiance = np.asarray(envmap.radiance)
    if radiance.shape[1] > 4 * face_px:
        radiance = resize_radiance(radiance, 4 * face_px)
    rest, lights, unit = _fit(radiance)
    if sun is not None:
        lights.insert(0, _Distant(name="sun", direction=sun.direction, irradiance=sun.irradiance))
    levels = int(np.log2(face_px // _SMALLEST_PX)) + 1
    pictures: list[bytes] = []
    for level in range(levels):
        filtered = prefilter_ggx(rest, level / (levels - 1))
        faces = _faces(filtered / np.float32(unit), face_px >> level)
        pictures += [encode_rgbd(face) for face in faces]
    irradiance = irradiance_harmonics(project_harmonics(rest, 2)) / unit
    value = _document(name, face_px, levels, unit, harmonics_for_tool(irradiance, "panokit"))
    _add_lights(value, lights)
    return _packed(value, pictures)


def encode_rgbd(pixels: NDArray[np.floating]) -> bytes:
    """Linear RGB (H, W, 3), 0 to 255, as a PNG of RGBD."""
    pixels = np.clip(np.asarray(pixels, np.float64), 0, _RGBD_TOP)
    top = np.maximum(pixels.max(axis=2), 1e-6)
    divider = np.clip(np.floor(_RGBD_TOP / top), 1, 255)
    scaled = np.clip(pixels * (divider / 255)[..., None], 0, 1) ** (1 / _GAMMA)
    codes = np.empty((*pixels.shape[:2], 4), np.uint8)
    codes[..., :3] = np.rint(scaled * 255)[..., ::-1]  # OpenCV writes BGRA
    codes[..., 3] = divider
    done, data = cv2.imencode(".png", codes)
    if not done:
        raise UsageError(f"Faces of {pixels.shape} cannot be written as PNG.")
    return bytes(data)


def _fit(
    radiance: NDArray[np.float32],
) -> tuple[NDArray[np.float32], list[_Distant], float]:
    """The map without what does not fit, that as lights, and the radiance that is 1 in RGBD."""
    height, width = radiance.shape[:2]
    unit = max(float(luminance(energy(radiance))) / (4 * np.pi), 1e-12)
    while True:
        limit = unit * _RGBD_TOP
        labels, count = label_regions(radiance.max(axis=2) > limit)
        if count <= _MOST_LIGHTS:
            break
        unit *= 2
    if count == 0:
        return radiance, [], unit
    fitting = np.minimum(radiance, np.float32(limit))
    parcels = (radiance - fitting) * row_solid_angles(height, width)[:, None, None]
    directions = equirect_directions(width, height)
    lights = []
    for number in range(1, count + 1):
        here = labels == number
        inside = parcels[here].astype(np.float64)
        middle = luminance(inside) @ directions[here]
        lights.append(
            _Distant(
                name=f"source {number}",
                direction=middle / np.linalg.norm(middle),
                irradiance=inside.sum(axis=0),
            )
        )
    return fitting, lights, unit


def _faces(radiance: NDArray[np.float32], size_px: int) -> list[NDArray[np.float32]]:
    """The faces in the file's order, made twice as wide first: small lights keep their energy."""
    row, _ = reproject(radiance, Equirectangular(), Cubemap(layout="row"), 12 * size_px)
    half = cv2.resize(row, (6 * size_px, size_px), interpolation=cv2.INTER_AREA)
    faces = split_faces(half, "row")
    return [np.rot90(faces[face], turns) for face, turns in _FACES]


def _document(
    name: str, face_px: int, levels: int, unit: float, irradiance: NDArray[np.float64]
) -> dict[str, Any]:
    """The JSON part, without the buffer."""
    light = {
        "name": name,
        "intensity": unit,
        "rotation": [0, 0, 0, 1],
        "irradianceCoefficients": [[float(f"{v:.9g}") for v in row] for row in irradiance],
        "specularImageSize": face_px,
        "specularImages": [[6 * level + face for face in range(6)] for level in range(levels)],
    }
    return {
        "asset": {"version": "2.0", "generator": "panokit"},
        "scene": 0,
        "scenes": [{"name": name, "extensions": {LIGHT: {"light": 0}}}],
        "extensionsUsed": [LIGHT],
        "extensions": {LIGHT: {"lights": [light]}},
    }


def _add_lights(value: dict[str, Any], lights: list[_Distant]) -> None:
    if not lights:
        return
    value["extensionsUsed"].append(PUNCTUAL)
    told, nodes = [], []
    for number, light in enumerate(lights):
        strength = max(float(light.irradiance.max()), 1e-30)
        told.append(
            {
                "name": light.name,
                "type": "directional",
                "intensity": float(f"{strength:.7g}"),
                "color": [round(float(v) / strength, 7) for v in light.irradiance],
            }
        )
        nodes.append(
            {
                "name": light.name,
                "rotation": [round(float(v), 9) for v in _quaternion(light.direction)],
                "extensions": {PUNCTUAL: {"light": number}},
            }
        )
    value["extensions"][PUNCTUAL] = {"lights": told}
    value["nodes"] = nodes
    value["scenes"][0]["nodes"] = list(range(len(nodes)))


def _quaternion(toward: NDArray[np.float64]) -> NDArray[np.float64]:
    """The turn (x, y, z, w) of a node that shines along its -Z, with the light coming from here."""
    side, up = axes_about(toward)
    m = np.stack([side, up, toward], axis=1)
    # From the largest of the four, so that nothing is divided by a small number.
    squares = np.array([
        1 + m[0, 0] - m[1, 1] - m[2, 2], 1 - m[0, 0] + m[1, 1] - m[2, 2],
        1 - m[0, 0] - m[1, 1] + m[2, 2], 1 + np.trace(m),
    ])  # fmt: skip
    sums = np.array([
        [squares[0], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[2, 1] - m[1, 2]],
        [m[0, 1] + m[1, 0], squares[1], m[1, 2] + m[2, 1], m[0, 2] - m[2, 0]],
        [m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], squares[2], m[1, 0] - m[0, 1]],
        [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], squares[3]],
    ])  # fmt: skip
    row = sums[int(np.argmax(squares))]
    return np.asarray(row / np.linalg.norm(row), np.float64)


def _packed(value: dict[str, Any], pictures: list[bytes]) -> bytes:
    """The .glb: header, JSON chunk, binary chunk; every part begins at a multiple of 4 bytes."""
    views, blob = [], bytearray()
    for picture in pictures:
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(picture)})
        blob += picture + b"\0" * (-len(picture) % 4)
    value["buffers"] = [{"byteLength": len(blob)}]
    value["bufferViews"] = views
    value["images"] = [
        {"bufferView": number, "mimeType": "image/png"} for number in range(len(views))
    ]
    text = json.dumps(value, separators=(",", ":"), sort_keys=True).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(blob), b"BIN\0") + bytes(blob)
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
