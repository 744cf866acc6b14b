"""The Mitsuba scene file, included in a scene and rendered."""

import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.io import write_exr
from panokit.io.adapters import AnalyticSun, mitsuba_scene, to_mitsuba
from panokit.renderer import load_mitsuba
from tests.io.adapters.conftest import BRIGHT, HEIGHT, direction_of

SCENE = """<scene version="3.0.0">
    <include filename="{included}"/>
    <integrator type="path"><integer name="max_depth" value="2"/></integrator>
    <sensor type="perspective">
        <float name="fov" value="{fov}"/>
        <transform name="to_world"><lookat origin="0,0,0" target="{target}" up="{up}"/></transform>
        <film type="hdrfilm">
            <integer name="width" value="33"/><integer name="height" value="33"/>
            <rfilter type="box"/>
        </film>
    </sensor>
{extra}</scene>
"""
SHEET = """    <shape type="rectangle">
        <transform name="to_world"><lookat origin="{place}" target="0,0,0" up="{up}"/></transform>
        <bsdf type="diffuse"><rgb name="reflectance" value="1"/></bsdf>
    </shape>
"""


def render(folder, target, *, extra="", fov=33.0, spp=16):
    mi = load_mitsuba()
    up = "0,0,1" if abs(target[1]) > 0.8 else "0,1,0"
    text = SCENE.format(
        included="probe.mitsuba.xml",
        fov=fov,
        target=",".join(map(str, target)),
        up=up,
        extra=extra.replace("{up}", up),
    )
    (folder / "scene.xml").write_text(text)
    return np.array(mi.render(mi.load_file(str(folder / "scene.xml")), spp=spp))


@pytest.mark.render
def test_mitsuba_shows_a_beacon_where_it_was(beacon, texel, tmp_path):
    envmap = beacon(*texel)
    write_exr(tmp_path / "probe.mitsuba.exr", to_mitsuba(envmap))
    (tmp_path / "probe.mitsuba.xml").write_text(mitsuba_scene("probe.mitsuba.exr"))
    picture = render(tmp_path, direction_of(*texel))
    rows, columns = np.mgrid[:33, :33] - 16
    weight = np.maximum(picture[..., 0] - 1, 0)
    offset = np.array([(weight * rows).sum(), (weight * columns).sum()]) / weight.sum()
    # A pixel of the picture is a degree; a quarter of a texel of the map is 1.4.
    assert np.abs(offset).max() < 1.4
    assert picture[16, 16, 0] > BRIGHT[0] / 4


@pytest.mark.render
def test_the_sun_gives_what_it_says(beacon, tmp_path):
    sun = AnalyticSun(direction=np.array([0.6, 0.64, -0.48]), irradiance=np.array([3.0, 2.0, 1.0]))
    black = np.zeros((HEIGHT, 2 * HEIGHT, 3), np.float32)
    write_exr(tmp_path / "probe.mitsuba.exr", black)
    (tmp_path / "probe.mitsuba.xml").write_text(mitsuba_scene("probe.mitsuba.exr", sun=sun))
    place = ",".join(f"{-4 * v}" for v in sun.direction)
    # A white sheet that faces the sun, seen with the sun at one's back.
    extra = SHEET.replace("{place}", place)
    picture = render(tmp_path, -sun.direction, extra=extra, fov=5.0, spp=256)
    # Each path looks at the sun or at the black map, as chance has it: the mean of many.
    seen = picture[12:21, 12:21].mean(axis=(0, 1))
    np.testing.assert_allclose(seen, sun.irradiance / np.pi, rtol=0.04)


def test_a_name_becomes_no_markup():
    assert 'value="a&amp;b.exr"' in mitsuba_scene("a&b.exr")
    with pytest.raises(UsageError):
        mitsuba_scene("")
