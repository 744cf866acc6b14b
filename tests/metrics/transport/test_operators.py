"""Laws of relighting: white furnace, one small lamp, linearity, turning, the adjoint."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from panokit.errors import ImageError, UsageError
from panokit.metrics.balls import ball_error, diffuse_ball, mirror_ball
from panokit.metrics.transport import SCENES, relight, transport
from panokit.sphere import equirect_directions
from panokit.sphere.solid_angle import pixel_solid_angles

BALLS = [scene for scene in SCENES if scene != "plane"]
ROUGH = [scene for scene in BALLS if not scene.startswith("mirror")]
SIZE = 32
WIDTH = 64


@pytest.fixture(scope="module", autouse=True)
def forget():
    yield
    transport.cache_clear()


def size_of(scene, size_px=SIZE):
    return None if scene == "plane" else size_px


def noise_map(seed, width=WIDTH):
    return np.random.default_rng(seed).exponential(size=(width // 2, width, 3)).astype(np.float32)


def lamp(direction, width=1024):
    """One texel with the irradiance 1 on a surface that faces it; its true direction."""
    directions = equirect_directions(width, width // 2)
    where = np.unravel_index(np.argmax(directions @ np.float32(direction)), directions.shape[:2])
    radiance = np.zeros((width // 2, width, 3), np.float32)
    radiance[where] = 1 / pixel_solid_angles(width // 2)[where]
    return radiance, directions[where].astype(np.float64)


def disc(size_px):
    across = (np.arange(size_px) + 0.5) / size_px * 2 - 1
    x, y = np.meshgrid(across, -across)
    inside = np.hypot(x, y) < 0.9
    return np.stack([x, y, np.sqrt(np.clip(1 - x**2 - y**2, 0, 1))], axis=-1), inside


@pytest.mark.parametrize(("scene", "albedo"), [("diffuse", 1.0), ("mirror", 1.0)])
def test_white_furnace_hides_a_white_ball(scene, albedo):
    picture = relight(np.full((32, 64, 3), 2.5, np.float32), scene, SIZE)
    assert picture[picture[..., 3] > 0][:, :3] == pytest.approx(2.5 * albedo, rel=1e-3)


@pytest.mark.parametrize("alpha", [0.1, 0.3, 0.6])
def test_a_rough_metal_seen_face_on_loses_what_its_facets_mask(alpha):
    # The facets' slopes are distributed as tan^2 = a^2 u / (1 - u) for even u; light that would
    # leave through the surface is lost, and the rest is masked by Smith's G1.
    u = (np.arange(200000) + 0.5) / 200000
    leaving = np.cos(2 * np.arctan(alpha * np.sqrt(u / (1 - u))))
    cosine = np.maximum(leaving, 0)
    masked = 2 * cosine / (cosine + np.sqrt(alpha**2 + (1 - alpha**2) * cosine**2))
    picture = relight(np.ones((32, 64, 3), np.float32), f"glossy-{alpha}", 33)
    assert picture[16, 16, 0] == pytest.approx(masked.mean(), rel=2e-3)


def test_one_lamp_shades_a_matte_ball_by_the_cosine():
    radiance, direction = lamp([0.6, 0.5, 0.4])
    picture = relight(radiance, "diffuse", 64)[..., 0]
    normals, inside = disc(64)
    expected = np.maximum(normals @ direction, 0) / np.pi
    assert picture[inside] == pytest.approx(expected[inside], abs=3e-3)


@pytest.mark.parametrize("direction", [[0.6, 0.5, 0.4], [0.0, 0.0, 1.0], [0.3, -0.6, -0.5]])
def test_one_lamp_has_its_highlight_where_the_normal_halves_the_angle(direction):
    radiance, direction = lamp(direction)
    half = np.add(direction, [0, 0, 1])
    half /= np.linalg.norm(half)
    for scene in ("mirror", "glossy-0.1"):
        picture = relight(radiance, scene, 65)
        row, column = np.unravel_index(np.argmax(picture[..., 0]), (65, 65))
        found = np.array([(column + 0.5) / 65 * 2 - 1, 1 - (row + 0.5) / 65 * 2])
        assert found == pytest.approx(half[:2], abs=0.05)


def test_a_metal_lobe_has_the_height_of_walter_and_others():
    # Straight back to the camera: D(0) / 4 = 1 / (4 pi a^2), with nothing masked.
    radiance, _ = lamp([0, 0, 1])
    for alpha in (0.1, 0.3, 0.6):
        found = relight(radiance, f"glossy-{alpha}", 257)[128, 128, 0]
        assert found == pytest.approx(1 / (4 * np.pi * alpha**2), rel=0.01)


def test_a_mirror_ball_keeps_a_lamps_light_wherever_it_stands():
    # Every direction of solid angle w is seen on an area w / 4 of the disc.
    for direction in ([0, 0, 1], [0, 0.9, 0.4], [1, 0.2, 0], [0.3, 0.3, -0.8]):
        radiance, _ = lamp(direction, 512)
        picture = relight(radiance, "mirror", 64)
        seen = (picture[..., 0] * picture[..., 3]).sum() * (2 / 64) ** 2
        assert seen == pytest.approx(0.25, rel=0.03)


def test_silver_is_a_mirror_that_brightens_to_its_rim():
    ones = np.ones((64, 128, 3), np.float32)
    silver = relight(ones, "mirror-silver", 65)[..., 0]
    assert silver[32, 32] == pytest.approx(0.8, abs=1e-3)
    # Schlick at the normal's 60 degrees: 0.8 + 0.2 * 0.5^5.
    column = int((np.sin(np.pi / 3) + 1) / 2 * 65)
    assert silver[32, column] == pytest.approx(0.8 + 0.2 / 32, abs=2e-3)
    assert silver[32, 64] > 0.84


@settings(max_examples=10, deadline=None)
@given(
    scene=st.sampled_from(SCENES),
    gain=st.floats(0.1, 100),
    seed=st.integers(0, 2**16),
)
def test_pictures_add_and_scale_as_light_does(scene, gain, seed):
    one, two = noise_map(seed), noise_map(seed + 1)
    both = relight(one + np.float32(gain) * two, scene, size_of(scene))
    parts = relight(one, scene, size_of(scene))
    parts[..., :3] += np.float32(gain) * relight(two, scene, size_of(scene))[..., :3]
    assert both == pytest.approx(parts, rel=1e-3, abs=1e-4 * (1 + gain))


@settings(max_examples=10, deadline=None)
@given(scene=st.sampled_from(SCENES), seed=st.integers(0, 2**16))
def test_adjoint_answers_the_inner_product(scene, seed):
    operator = transport(scene, WIDTH, size_of(scene))
    radiance = noise_map(seed)
    side = operator.size_px
    image = np.random.default_rng(seed).normal(size=(side, side, 3)).astype(np.float32)
    there = np.float64(operator.forward(radiance)) * image
    back = radiance * np.float64(operator.adjoint(image))
    assert there.sum() == pytest.approx(back.sum(), rel=1e-4, abs=1e-3 * np.abs(there).sum())


@pytest.mark.parametrize("scene", ["glossy-0.3", "mirror", "plane"])
def test_adjoint_is_the_gradient_of_a_loss(scene):
    operator = transport(scene, WIDTH, size_of(scene))
    radiance, target = noise_map(1), operator.forward(noise_map(2))
    gradient = operator.adjoint(2 * (operator.forward(radiance) - target))

    def loss(values):
        return ((np.float64(operator.forward(values)) - target) ** 2).sum()

    for where in [(3, 10, 0), (12, 40, 1), (15, 60, 2)]:
        nudge = np.zeros_like(radiance)
        nudge[where] = 0.5
        slope = loss(radiance + nudge) - loss(radiance - nudge)
        least = 2e-3 * float(np.abs(gradient).max())
        assert slope == pytest.approx(float(gradient[where]), rel=2e-2, abs=least)


@pytest.mark.parametrize("scene", BALLS)
def test_light_turned_about_the_camera_turns_the_picture(scene):
    directions = equirect_directions(256, 128)

    def sky(points):
        near = np.exp(20 * (points @ np.float32([0.48, 0.6, 0.64]) - 1))
        return np.stack([0.2 + near, 0.3 + 0.2 * points[..., 1], 0.1 + near**2], axis=-1)

    # Counterclockwise as the camera sees it: what was right (+X) is now at the top (+Y).
    before_turn = np.stack([directions[..., 1], -directions[..., 0], directions[..., 2]], axis=-1)
    straight = relight(sky(directions), scene, SIZE)
    turned = relight(sky(before_turn), scene, SIZE)
    assert ball_error(turned, np.rot90(straight)) < 3e-3
    assert ball_error(turned, straight) > 0.02


@pytest.mark.parametrize("scene", ["diffuse", "mirror", "glossy-0.1"])
def test_alpha_is_the_disc_and_nothing_else_shines(scene):
    picture = relight(np.ones((16, 32, 3), np.float32), scene, 48)
    assert picture.shape == (48, 48, 4)
    assert picture.dtype == np.float32
    assert picture[..., 3].mean() == pytest.approx(np.pi / 4, rel=1e-3)
    assert picture[0, 0].tolist() == [0, 0, 0, 0]
    assert picture[24, 24, 3] == 1
    rim = picture[..., 3][(picture[..., 3] > 0) & (picture[..., 3] < 1)]
    assert len(rim) > 48


def test_maps_of_every_size_give_one_picture():
    directions = {width: equirect_directions(width, width // 2) for width in (34, 256, 600)}
    for scene in ("diffuse", "mirror", "plane"):
        pictures = [
            relight(1 + 0.5 * points, scene, size_of(scene)) for points in directions.values()
        ]
        for picture in pictures[:-1]:
            assert ball_error(picture, pictures[-1]) < 0.01


def test_agrees_with_the_plain_balls():
    directions = equirect_directions(256, 128)
    radiance = np.exp(3 * directions).astype(np.float32)
    assert ball_error(diffuse_ball(radiance, 64), relight(radiance, "diffuse", 64)) < 0.01
    # The plain mirror ball takes sixteen rays through a pixel; that is coarse at the rim.
    assert ball_error(mirror_ball(radiance, 64), relight(radiance, "mirror", 64)) < 0.03


def test_default_sizes():
    ones = np.ones((16, 32, 3), np.float32)
    assert relight(ones, "diffuse").shape == (128, 128, 4)
    assert relight(ones, "plane").shape == (64, 64, 4)


@pytest.mark.parametrize(
    ("radiance", "message"),
    [
        (np.ones((16, 32), np.float32), "RGB"),
        (np.ones((16, 32, 1), np.float32), "RGB"),
        (np.ones((0, 0, 3), np.float32), "too small"),
        (np.ones((16, 30, 3), np.float32), "twice as wide"),
        (np.ones((16, 32, 3), np.uint8), "srgb_decode"),
        (np.full((16, 32, 3), np.nan, np.float32), "infinite or undefined"),
        (np.full((16, 32, 3), np.inf, np.float32), "infinite or undefined"),
    ],
)
def test_maps_that_are_none_are_refused(radiance, message):
    with pytest.raises(ImageError, match=message):
        relight(radiance, "diffuse")


def test_wrong_arguments_are_refused():
    ones = np.ones((16, 32, 3), np.float32)
    with pytest.raises(UsageError, match="no scene 'shiny'; the scenes are diffuse, "):
        relight(ones, "shiny")
    with pytest.raises(UsageError, match="64 pixels wide, not 100"):
        relight(ones, "plane", 100)
    for scene in ("diffuse", "mirror"):
        with pytest.raises(UsageError, match="4 to 1024 pixels wide, not 2"):
            relight(ones, scene, 2)
    with pytest.raises(UsageError, match="16 pixels wide or more"):
        transport("diffuse", 7)
    operator = transport("diffuse", 32, 16)
    with pytest.raises(UsageError, match=r"map of shape \(16, 32, 3\), not \(8, 16, 3\)"):
        operator.forward(np.ones((8, 16, 3), np.float32))
    with pytest.raises(UsageError, match=r"picture of shape \(16, 16, 3\)"):
        operator.adjoint(np.ones((8, 8, 3), np.float32))
