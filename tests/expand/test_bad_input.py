"""Pictures that are not what a network hopes for: each has one clear outcome."""

import json
import tracemalloc

import cv2
import numpy as np
import pytest

from panokit.cli.main import main
from panokit.color import luminance, srgb_decode_u8
from panokit.envmap import EnvironmentMap
from panokit.errors import ImageError
from panokit.expand import ExpandSettings, expand
from panokit.io import read_environment_map, write_environment_map
from panokit.io.images import encode_png
from panokit.panorama import Panorama

MODELS = ("srgb", "reinhard", "area", "expand-1")


def expanded(pixels, capture, model: str = "expand-1", width_px: int = 256):
    settings = ExpandSettings(model=model, width_px=width_px)
    return expand(Panorama(pixels=pixels, capture=capture), settings)


def texture(seed: int = 0, *, low: int = 20, high: int = 200, height: int = 128) -> np.ndarray:
    random = np.random.default_rng(seed)
    coarse = random.integers(low, high, (height // 8, height // 4, 3), dtype=np.uint8)
    return coarse.repeat(8, axis=0).repeat(8, axis=1)


@pytest.mark.parametrize("model", MODELS)
def test_a_black_picture_is_refused(capture, model):
    pixels = np.random.default_rng(0).integers(0, 3, (128, 256, 3), dtype=np.uint8)
    with pytest.raises(ImageError) as caught:
        expanded(pixels, capture, model)
    assert caught.value.reason == "black"


@pytest.mark.parametrize("model", MODELS)
def test_a_white_picture_is_refused(capture, model):
    pixels = np.full((128, 256, 3), 255, np.uint8)
    with pytest.raises(ImageError) as caught:
        expanded(pixels, capture, model)
    assert caught.value.reason == "burnt-out"
    assert caught.value.values["burnt_share"] == pytest.approx(1)


@pytest.mark.parametrize("model", ["srgb", "area", "expand-1", "expand-2"])
def test_where_nothing_is_burnt_out_the_map_is_the_decoded_picture(capture, model):
    pixels = texture()
    result = expanded(pixels, capture, model)
    values = result.provenance.last("expand").values
    assert result.radiance == pytest.approx(srgb_decode_u8(pixels), abs=1e-6)
    assert values["burnt_share"] == 0
    assert not values.get("component_gains")
    assert values.get("curve_slopes", [1, 1]) == [1, 1]
    assert values["energy_after"] == pytest.approx(values["energy_before"], rel=1e-5)
    assert values["lighting"]["sun"] is None


def test_one_burnt_out_pixel_changes_little_else(capture):
    pixels = texture()
    before = expanded(pixels, capture).radiance
    pixels[60, 100] = 255
    after = expanded(pixels, capture).radiance
    others = np.ones(before.shape[:2], bool)
    others[60, 100] = False
    assert np.abs(after / before - 1)[others].max() < 0.02
    assert luminance(after)[60, 100] >= 1


def test_a_single_burnt_out_channel_is_a_color_and_no_lamp(capture):
    pixels = texture()
    pixels[40:48, 80:90] = (255, 120, 30)
    assert expanded(pixels, capture).radiance.max() <= 1


def test_a_night_gets_its_lamps_and_stays_dark_elsewhere(capture):
    pixels = texture(low=2, high=14)
    pixels[30:33, 60:63] = 255
    pixels[36:38, 180:183] = (255, 252, 140)
    result = expanded(pixels, capture)
    light = luminance(result.radiance)
    shown = luminance(srgb_decode_u8(pixels))
    dark = np.ones(light.shape, bool)
    dark[26:42] = False
    assert light[dark].max() < 0.02
    assert light[31, 61] > 2
    assert light[36, 181] > 1
    assert light.sum() > shown.sum()
    assert np.isfinite(result.radiance).all()


def test_64_pixels_are_too_few_for_the_network_and_enough_for_formulas(capture):
    pixels = texture(height=32)
    pixels[4:6, 10:12] = 255
    with pytest.raises(ImageError) as caught:
        expanded(pixels, capture)
    assert caught.value.reason == "too-small"
    assert "srgb" in str(caught.value)
    assert expanded(pixels, capture, "area").width_px == 64


def test_each_bad_picture_has_one_outcome_on_the_command_line(tmp_path, capsys):
    night = texture(low=2, high=14)
    night[30:33, 60:63] = 255
    pictures = {
        "black": np.zeros((128, 256, 3), np.uint8),
        "white": np.full((128, 256, 3), 255, np.uint8),
        "tiny": texture(height=32),
        "dull": texture(),
        "night": night,
        "long": texture()[:, :200],
    }
    for name, pixels in pictures.items():
        (tmp_path / f"{name}.png").write_bytes(encode_png(pixels))
    out = tmp_path / "out"
    inputs = [str(tmp_path / f"{name}.png") for name in pictures]
    assert main(["expand", *inputs, "--out", str(out), "--json"]) == 1
    (result,) = json.loads(capsys.readouterr().out)
    reasons = {entry["item"]: entry["reason"] for entry in result["rejected"]}
    assert reasons == {
        "black": "black",
        "white": "burnt-out",
        "tiny": "too-small",
        "long": "not-equirectangular",
    }
    assert sorted(entry["item"] for entry in result["done"]) == ["dull", "night"]
    # Half a map is never left behind.
    assert {path.stem for path in out.glob("*.exr")} == {"dull", "night"}
    dull = read_environment_map(out / "dull.exr").radiance
    assert dull == pytest.approx(srgb_decode_u8(pictures["dull"]), abs=1e-6)
    assert luminance(read_environment_map(out / "night.exr").radiance).max() > 2


def test_a_map_that_is_narrower_than_asked_for_says_so(tmp_path, capsys):
    for name in ("a", "b"):
        (tmp_path / f"{name}.png").write_bytes(encode_png(texture()))
    arguments = ["expand", str(tmp_path / "a.png"), str(tmp_path / "b.png"), "--model", "srgb"]
    assert main([*arguments, "--out", str(tmp_path / "o")]) == 0
    said = capsys.readouterr().err
    assert "a and 1 more: narrower than --width-px" in said
    record = json.loads((tmp_path / "o" / "a.json").read_text(encoding="utf-8"))
    values = record["provenance"][-1]["values"]
    assert (values["width_px"], values["width_limited_by_panorama"]) == (256, True)
    assert main([*arguments, "--out", str(tmp_path / "p"), "--width-px", "256"]) == 0
    assert "narrower" not in capsys.readouterr().err


def test_hdr_maps_and_pictures_that_are_not_2_to_1_are_rejected_by_name(tmp_path, capsys):
    envmap = EnvironmentMap(radiance=np.ones((64, 128, 3), np.float32))
    write_environment_map(envmap, tmp_path / "bright.exr")
    (tmp_path / "wide.png").write_bytes(encode_png(texture()[:, :200]))
    (tmp_path / "good.png").write_bytes(encode_png(texture()))
    inputs = [str(tmp_path / name) for name in ("bright.exr", "wide.png", "good.png")]
    out = tmp_path / "out"
    assert main(["expand", *inputs, "--out", str(out), "--model", "srgb", "--json"]) == 1
    (result,) = json.loads(capsys.readouterr().out)
    reasons = {entry["item"]: entry["reason"] for entry in result["rejected"]}
    assert reasons == {"bright": "is-hdr", "wide": "not-equirectangular"}
    assert [entry["item"] for entry in result["done"]] == ["good"]


def test_float_pixels_are_refused_where_a_panorama_is_made(capture):
    with pytest.raises(ImageError) as caught:
        Panorama(pixels=np.ones((64, 128, 3), np.float32), capture=capture)
    assert caught.value.reason == "wrong-dtype"
    assert "EnvironmentMap" in str(caught.value)


@pytest.mark.slow
def test_8k_keeps_its_width_in_bounded_memory(capture):
    small = texture(high=120, height=256)
    small[60:64, 100:110] = 255
    pixels = cv2.resize(small, (8192, 4096), interpolation=cv2.INTER_NEAREST)
    panorama = Panorama(pixels=pixels, capture=capture)
    tracemalloc.start()
    result = expand(panorama, ExpandSettings(model="area", width_px=8192))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert result.width_px == 8192
    assert luminance(result.radiance[960:1024, 1600:1760]).min() > 1.5
    # The map alone is 400 MB; all planes of the picture would be 1500.
    assert peak < 1.1e9


@pytest.mark.slow
def test_16k_needs_no_more_memory_than_its_pixels_and_a_few_maps(capture):
    small = texture(high=120, height=256)
    small[60:64, 100:110] = 255
    pixels = cv2.resize(small, (16384, 8192), interpolation=cv2.INTER_NEAREST)
    panorama = Panorama(pixels=pixels, capture=capture)
    tracemalloc.start()
    result = expand(panorama, ExpandSettings())
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert result.width_px == 1024
    assert luminance(result.radiance).max() > 2
    assert peak < 400e6
