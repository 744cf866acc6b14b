import numpy as np
import pytest

from panokit.color import srgb_decode_u8
from panokit.expand.baselines import (
    REINHARD_WHITE,
    SHIPPED_AREA_RULE,
    AreaRule,
    expand_area,
    expand_reinhard,
    expand_srgb,
)
from panokit.expand.components import find_components
from panokit.expand.reduce import reduce_panorama


def gray(code: int) -> np.ndarray:
    return np.full((16, 32, 3), code, np.uint8)


def test_srgb_is_the_decoded_picture(lamps):
    assert np.allclose(expand_srgb(reduce_panorama(lamps, 256)), srgb_decode_u8(lamps))


def test_reinhard_takes_white_to_its_white_and_undoes_the_curve():
    assert expand_reinhard(reduce_panorama(gray(255), 32)).max() == pytest.approx(
        REINHARD_WHITE, rel=1e-4
    )
    shown = float(srgb_decode_u8(gray(120))[0, 0, 0])
    light = float(expand_reinhard(reduce_panorama(gray(120), 32))[0, 0, 0])
    forward = light * (1 + light / REINHARD_WHITE**2) / (1 + light)
    assert forward == pytest.approx(shown, rel=1e-4)


def test_the_area_rule_multiplies_each_component_by_its_own_gain(lamps):
    reduced = reduce_panorama(lamps, 256)
    components = find_components(reduced)
    rule = AreaRule(offset=0.2, slope=-0.5)
    ratio = expand_area(reduced, rule) / np.maximum(reduced.linear, 1e-9)
    for k, solid_angle in enumerate(components.solid_angle):
        expected = np.exp(0.2 - 0.5 * np.log(solid_angle))
        assert ratio[components.labels == k + 1] == pytest.approx(expected, rel=1e-3)
    assert ratio[components.labels == 0] == pytest.approx(1)


def test_the_area_rule_never_darkens(lamps):
    reduced = reduce_panorama(lamps, 256)
    darker = expand_area(reduced, AreaRule(offset=-5, slope=0))
    assert np.allclose(darker, reduced.linear)


def test_the_shipped_rule_gives_small_lamps_more_than_skies():
    assert SHIPPED_AREA_RULE.slope < 0
