"""The .glb file: its structure, and where a beacon is by the specification's cube map."""

import json
import struct

import cv2
import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.errors import UsageError
from panokit.frames import angle_between
from panokit.io.adapters import AnalyticSun, gltf_environment
from panokit.io.adapters.gltf import encode_rgbd
from panokit.sphere import energy, irradiance
from tests.io.adapters.conftest import BRIGHT, direction_of

FACE_PX = 64
# The OpenGL specification's table, "Selection of cube map images": the axis of the face with its
# sign, then what s and t grow along.
OPENGL_FACES = [
    ((0, +1), (2, -1), (1, -1)),
    ((0, -1), (2, +1), (1, -1)),
    ((1, +1), (0, +1), (2, +1)),
    ((1, -1), (0, +1), (2, -1)),
    ((2, +1), (0, +1), (1, -1)),
    ((2, -1), (0, -1), (1, -1)),
]


def unpacked(data):
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    size, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON"
    assert size % 4 == 0
    value = json.loads(data[20 : 20 + size])
    blob_size, kind = struct.unpack_from("<I4s", data, 20 + size)
    assert kind == b"BIN\0"
    blob = data[28 + size :]
    assert len(blob) == blob_size == value["buffers"][0]["byteLength"]
    return value, blob


def pictures_of(value, blob):
    """Decoded as Babylon.js does: gamma 2.2, divided by alpha."""
    made = []
    for image in value["images"]:
        assert image["mimeType"] == "image/png"
        view = value["bufferViews"][image["bufferView"]]
        assert view["byteOffset"] % 4 == 0
        png = blob[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
        bgra = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_UNCHANGED) / 255
        assert bgra.shape[2] == 4
        made.append(bgra[..., 2::-1] ** 2.2 / bgra[..., 3:])
    return made


def looked_up(faces, direction):
    """The texel behind a direction: OpenGL's table, each image mirrored left to right."""
    axis = int(np.argmax(np.abs(direction)))
    number = 2 * axis + (direction[axis] < 0)
    _, (s_axis, s_sign), (t_axis, t_sign) = OPENGL_FACES[number]
    s = (s_sign * direction[s_axis] / abs(direction[axis]) + 1) / 2
    t = (t_sign * direction[t_axis] / abs(direction[axis]) + 1) / 2
    size = faces[number].shape[0]
    column, row = int((1 - s) * size), int(t * size)
    return faces[number], min(row, size - 1), min(column, size - 1)


def texels_of(number):
    """The directions and solid angles of a face's texels, by the same table."""
    (axis, sign), (s_axis, s_sign), (t_axis, t_sign) = OPENGL_FACES[number]
    places = (np.arange(FACE_PX) + 0.5) / FACE_PX * 2 - 1
    toward = np.empty((FACE_PX, FACE_PX, 3))
    toward[..., axis] = sign
    toward[..., s_axis] = s_sign * -places[None, :]  # mirrored left to right
    toward[..., t_axis] = t_sign * places[:, None]
    length = np.linalg.norm(toward, axis=-1)
    return toward / length[..., None], length**-3


def test_a_beacon_is_where_it_was(beacon, texel):
    radiance = beacon(*texel).radiance * np.float32(0.125)  # 50, 25, 12.5: it fits into RGBD
    radiance = np.maximum(radiance, np.float32(0.5))
    envmap = EnvironmentMap(radiance=radiance)
    value, blob = unpacked(gltf_environment(envmap, name="b", face_px=FACE_PX))
    assert value["extensionsUsed"] == ["EXT_lights_image_based"]
    light = value["extensions"]["EXT_lights_image_based"]["lights"][0]
    assert light["rotation"] == [0, 0, 0, 1]
    faces = pictures_of(value, blob)[:6]
    middle = sum(
        np.einsum("ij,ijk->k", np.maximum(face[..., 0] - 2, 0) * angles, toward)
        for face, (toward, angles) in zip(faces, map(texels_of, range(6)), strict=True)
    )
    # Half a texel of the map is 2.8 degrees.
    assert angle_between(middle, direction_of(*texel)) < np.deg2rad(0.7)
    if 4 < texel[0] < 28:  # near the poles texels are narrower than those of the faces
        face, row, column = looked_up(faces, direction_of(*texel))
        np.testing.assert_allclose(face[row, column] * light["intensity"], BRIGHT / 8, rtol=0.2)


def test_each_level_is_half_as_wide_down_to_16_and_blurred_around_the_beacon(beacon):
    value, blob = unpacked(gltf_environment(beacon(9, 50), name="b", face_px=FACE_PX))
    light = value["extensions"]["EXT_lights_image_based"]["lights"][0]
    pictures = pictures_of(value, blob)
    assert light["specularImageSize"] == FACE_PX
    widths = [[pictures[i].shape[0] for i in level] for level in light["specularImages"]]
    assert widths == [[64] * 6, [32] * 6, [16] * 6]
    direction = direction_of(9, 50)
    peaks = []
    for level in light["specularImages"]:
        faces = [pictures[i] for i in level]
        face, row, column = looked_up(faces, direction)
        peaks.append(face[row, column, 0])
        assert peaks[-1] >= 0.9 * max(f[..., 0].max() for f in faces)
    assert peaks[0] > 2 * peaks[1] > 4 * peaks[2]


def test_the_scene_has_the_light_and_the_extensions_are_named(beacon):
    value, _ = unpacked(gltf_environment(beacon(9, 50), name="b", face_px=FACE_PX))
    assert value["asset"]["version"] == "2.0"
    assert "EXT_lights_image_based" in value["extensionsUsed"]
    assert "extensionsRequired" not in value
    scene = value["scenes"][value["scene"]]
    assert scene["extensions"] == {"EXT_lights_image_based": {"light": 0}}


def test_the_coefficients_are_those_of_irradiance_in_the_common_order():
    rng = np.random.default_rng(0)
    radiance = rng.uniform(0.2, 1.0, (32, 64, 3)).astype(np.float32)
    radiance[:8] *= 3
    value, _ = unpacked(gltf_environment(EnvironmentMap(radiance=radiance), name="b", face_px=32))
    light = value["extensions"]["EXT_lights_image_based"]["lights"][0]
    rows = np.array(light["irradianceCoefficients"]) * light["intensity"]
    assert rows.shape == (9, 3)
    normals = rng.normal(size=(50, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    x, y, z = normals.T
    # Ramamoorthi and Hanrahan 2001, equation 3.
    basis = np.stack([
        np.full(50, 0.282095), 0.488603 * y, 0.488603 * z, 0.488603 * x, 1.092548 * x * y,
        1.092548 * y * z, 0.315392 * (3 * z**2 - 1), 1.092548 * x * z,
        0.546274 * (x**2 - y**2),
    ], axis=1)  # fmt: skip
    np.testing.assert_allclose(basis @ rows, irradiance(radiance, normals), rtol=0.02)


def test_what_does_not_fit_becomes_lights_and_no_energy_is_lost():
    radiance = np.full((64, 128, 3), 0.5, np.float32)
    radiance[20, 30] = [9e5, 8e5, 7e5]
    radiance[40, 90] = [3e5, 3e5, 3e5]
    envmap = EnvironmentMap(radiance=radiance)
    value, blob = unpacked(gltf_environment(envmap, name="b", face_px=128))
    lights = value["extensions"]["KHR_lights_punctual"]["lights"]
    assert [light["type"] for light in lights] == ["directional"] * 2
    assert value["scenes"][0]["nodes"] == [0, 1]
    toward = []
    for node in value["nodes"]:
        x, y, z, w = node["rotation"]
        # The image of +Z under the node's turn: where the light comes from.
        toward.append([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
    np.testing.assert_allclose(
        toward, [direction_of(20, 30, 64), direction_of(40, 90, 64)], atol=1e-6
    )
    apart = sum(light["intensity"] * np.array(light["color"]) for light in lights)
    ibl = value["extensions"]["EXT_lights_image_based"]["lights"][0]
    # Coefficient 0 of irradiance is pi times 0.282095 times the energy.
    rest = np.array(ibl["irradianceCoefficients"][0]) * ibl["intensity"] / (np.pi * 0.282095)
    np.testing.assert_allclose(rest + apart, energy(radiance), rtol=1e-4)
    assert max(f.max() for f in pictures_of(value, blob)) <= 255.1


def test_a_sun_apart_is_a_light_of_the_file(beacon):
    sun = AnalyticSun(direction=np.array([0.6, 0.64, -0.48]), irradiance=np.array([3.0, 2.0, 1.0]))
    flat = EnvironmentMap(radiance=np.full((16, 32, 3), 0.5, np.float32))
    value, _ = unpacked(gltf_environment(flat, name="b", face_px=32, sun=sun))
    (light,) = value["extensions"]["KHR_lights_punctual"]["lights"]
    assert light["name"] == "sun"
    np.testing.assert_allclose(np.multiply(light["color"], light["intensity"]), [3, 2, 1], 1e-6)


def test_rgbd_holds_1_to_255_times_white():
    values = np.geomspace(0.05, 255, 64, dtype=np.float32)
    pixels = np.stack([values, values / 2, values / 3], axis=-1)[None]
    bgra = cv2.imdecode(np.frombuffer(encode_rgbd(pixels), np.uint8), cv2.IMREAD_UNCHANGED) / 255
    back = bgra[..., 2::-1] ** 2.2 / bgra[..., 3:]
    np.testing.assert_allclose(back, pixels, rtol=0.05)


@pytest.mark.parametrize("face_px", [16, 48, 0])
def test_faces_are_powers_of_two(beacon, face_px):
    with pytest.raises(UsageError, match="32, 64"):
        gltf_environment(beacon(9, 50), name="b", face_px=face_px)
