"""Panorama, EnvironmentMap, Provenance and Rejection keep what they promise."""

import numpy as np
import pytest

from panokit.capture import local_capture
from panokit.envmap import EnvironmentMap
from panokit.errors import ImageError, ItemError, PanokitError, RecordError, Rejection
from panokit.panorama import Panorama
from panokit.provenance import Provenance, Step, canonical_json, digest_of
from panokit.settings import Settings


def pixels(height=16, width=32, dtype=np.uint8):
    return np.zeros((height, width, 3), dtype)


@pytest.mark.parametrize(
    ("bad", "reason"),
    [
        (pixels(dtype=np.float32), "wrong-dtype"),
        (pixels(16, 48), "not-equirectangular"),
        (pixels(1, 1), "not-equirectangular"),
        (pixels(1, 2), "too-small"),
        (np.zeros((16, 32), np.uint8), "wrong-channels"),
        (np.zeros((16, 32, 4), np.uint8), "wrong-channels"),
    ],
)
def test_panoramas_refuse_what_they_are_not(bad, reason):
    with pytest.raises(ImageError) as caught:
        Panorama(pixels=bad, capture=local_capture("a"))
    assert caught.value.reason == reason


def test_valid_mask_must_fit_and_a_full_one_is_none():
    capture = local_capture("a")
    with pytest.raises(ImageError, match="mask"):
        Panorama(pixels=pixels(), capture=capture, valid=np.ones((8, 16), bool))
    whole = Panorama(pixels=pixels(), capture=capture, valid=np.ones((16, 32), bool))
    assert whole.valid is None


def test_values_are_read_only_but_the_callers_array_is_not():
    mine = pixels()
    panorama = Panorama(pixels=mine, capture=local_capture("a"))
    with pytest.raises(ValueError, match="read-only"):
        panorama.pixels[0, 0] = 1
    mine[0, 0] = 1


@pytest.mark.parametrize(
    ("value", "word"), [(np.nan, "1 nan"), (np.inf, "1 inf"), (-1.0, "1 negative")]
)
def test_maps_refuse_unphysical_light(value, word):
    radiance = pixels(dtype=np.float32)
    radiance[3, 4, 1] = value
    with pytest.raises(ImageError, match=word) as caught:
        EnvironmentMap(radiance=radiance)
    assert caught.value.reason == "not-physical"


def test_maps_refuse_half_floats():
    with pytest.raises(ImageError, match="float16"):
        EnvironmentMap(radiance=pixels(dtype=np.float16))


def test_provenance_grows_and_is_stable():
    first = Step(stage="fetch", version="1")
    chain = Provenance().then(first).then(Step(stage="stitch", version="2", values={"tiles": 8}))
    assert Provenance.from_json(chain.to_json()) == chain
    assert chain.last("stitch").values == {"tiles": 8}
    assert chain.last("expand") is None
    assert chain.digest == Provenance.from_json(chain.to_json()).digest
    assert chain.with_inputs(["ab"]).steps[-1].input_digests == ("ab",)
    with pytest.raises(RecordError):
        Provenance.from_json([{"stage": "x"}])


def test_equal_values_have_equal_digests():
    assert digest_of({"a": 1, "b": [2]}) == digest_of({"b": [2], "a": 1})
    assert canonical_json({"b": "é", "a": 1}) == '{"a":1,"b":"é"}'


def test_settings_are_frozen_strict_and_digested():
    class Small(Settings):
        size_px: int = 3

    assert Small().digest == Small(size_px=3).digest != Small(size_px=4).digest
    with pytest.raises(ValueError, match="Extra inputs"):
        Small(size=3)
    with pytest.raises(ValueError, match="frozen"):
        Small().size_px = 4


def test_an_item_error_becomes_a_rejection():
    error = ItemError("No sky.", reason="no-sky", values={"share": 0.0})
    rejection = Rejection.from_error("p1", "qa", error)
    assert rejection.to_json() == {
        "item": "p1",
        "stage": "qa",
        "reason": "no-sky",
        "message": "No sky.",
        "values": {"share": 0.0},
    }


def test_every_error_says_how_to_exit():
    def tree(kind):
        return [kind, *(t for child in kind.__subclasses__() for t in tree(child))]

    kinds = [kind for kind in tree(PanokitError) if kind.__module__ == "panokit.errors"]
    assert {kind.__name__ for kind in kinds} >= {"UsageError", "StorageError", "LicenseError"}
    for kind in kinds:
        assert kind.exit_code != 0
        assert kind.__name__ in __import__("panokit.errors", fromlist=["x"]).__doc__
