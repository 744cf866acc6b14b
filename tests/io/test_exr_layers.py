import pytest

from panokit.errors import ImageError
from panokit.io.exr_layers import choose_layer, layers_of

BLENDER = [
    *(f"ViewLayer.{name}.{c}" for name in ("Combined", "DiffCol") for c in "RGBA"),
    "ViewLayer.Depth.Z",
    *(f"ViewLayer.Normal.{c}" for c in "XYZ"),
]


def test_only_colors_are_layers():
    names = [layer.name for layer in layers_of(BLENDER)]
    assert names == ["ViewLayer.Combined", "ViewLayer.DiffCol"]
    assert choose_layer(BLENDER, "ViewLayer.DiffCol", "a.exr").channels == tuple(
        f"ViewLayer.DiffCol.{c}" for c in "RGB"
    )


def test_the_plain_layer_wins_and_other_spellings_are_known():
    assert choose_layer(["R", "G", "B", "A", "glow.R", "glow.G", "glow.B"], None, "").name == ""
    assert choose_layer(["red", "green", "blue"], None, "").channels == ("red", "green", "blue")
    assert choose_layer(["r", "g", "b"], None, "").kind == "rgb"
    assert choose_layer(["BY", "RY", "Y"], None, "").channels == ("Y", "RY", "BY")


@pytest.mark.parametrize(
    ("channels", "layer", "message"),
    [
        (BLENDER, None, r"2 layers.*'ViewLayer.Combined', 'ViewLayer.DiffCol'"),
        (BLENDER, "ViewLayer.Glossy", r"no layer 'ViewLayer.Glossy'.*Choose one"),
        (["Z"], None, r"one channel, Z.*layer='Z'"),
        (["Z", "A"], None, r"one channel, Z"),
        (["X", "Y", "Z"], None, r"no channels R, G and B\. It has: X, Y, Z"),
        ([], None, r"It has: none"),
    ],
)
def test_what_cannot_be_chosen(channels, layer, message):
    with pytest.raises(ImageError, match=message) as caught:
        choose_layer(channels, layer, "a.exr")
    assert caught.value.reason == "wrong-channels"
