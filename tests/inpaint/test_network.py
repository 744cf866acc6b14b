"""A stand-in for LaMa: an ONNX file that paints the hole in one color."""

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper

from panokit.errors import ModelError, UsageError
from panokit.inpaint import InpaintSettings, inpaint
from panokit.inpaint.network import InpaintingNetwork

COLOR = (0.9, 0.2, 0.4)
SHAPE = (1, 3, 512, 512)


def write(path, *, scale=255.0, inputs=2, channels_last=False):
    """image * (1 - mask) + color * mask, times `scale`."""
    image = helper.make_tensor_value_info("image", TensorProto.FLOAT, SHAPE)
    mask = helper.make_tensor_value_info("mask", TensorProto.FLOAT, (1, 1, 512, 512))
    one, tint, gain = (
        numpy_helper.from_array(np.asarray(value, np.float32), name)
        for name, value in (
            ("one", 1.0),
            ("tint", np.reshape(COLOR, (1, 3, 1, 1))),
            ("gain", scale),
        )
    )
    nodes = [
        helper.make_node("Sub", ["one", "mask"], ["keep"]),
        helper.make_node("Mul", ["image", "keep"], ["kept"]),
        helper.make_node("Mul", ["tint", "mask"], ["painted"]),
        helper.make_node("Add", ["kept", "painted"], ["sum"]),
        helper.make_node("Mul", ["sum", "gain"], ["planes"]),
    ]
    result = "planes"
    if channels_last:
        nodes.append(helper.make_node("Transpose", ["planes"], ["pixels"], perm=[0, 2, 3, 1]))
        result = "pixels"
    if inputs == 1:
        nodes, result = [helper.make_node("Mul", ["image", "gain"], ["planes"])], "planes"
    given = [image, mask][:inputs]
    output = helper.make_tensor_value_info(result, TensorProto.FLOAT, None)
    graph = helper.make_graph(nodes, "stand-in", given, [output], [one, tint, gain])
    opsets = [helper.make_opsetid("", 13)]
    onnx.save(helper.make_model(graph, opset_imports=opsets, ir_version=8), path)
    return path


@pytest.mark.parametrize("scale", [1.0, 255.0])
def test_the_network_paints_the_hole_and_nothing_else(
    tmp_path, textured, panorama_of, cap_around, scale
):
    pixels = textured(512)
    hole = cap_around(512, (0, -1, 0), 15)
    path = write(tmp_path / "lama.onnx", scale=scale)
    settings = InpaintSettings(method="network", network=path, nadir_deg=15, fill_black=False)
    filled = inpaint(panorama_of(pixels), settings)
    assert np.allclose(filled.pixels[hole].mean(axis=0), 255 * np.array(COLOR), atol=3)
    away = ~cap_around(512, (0, -1, 0), 17.5)
    assert np.array_equal(filled.pixels[away], pixels[away])
    (filling,) = filled.provenance.steps[-1].values["fillings"]
    assert filling["method"] == "network"


def test_a_file_that_is_not_there_is_a_wrong_call(tmp_path):
    with pytest.raises(UsageError, match="There is no"):
        InpaintingNetwork(tmp_path / "none.onnx")


def test_another_kind_of_network_is_told_from_one_for_inpainting(tmp_path):
    with pytest.raises(ModelError, match="image and a mask"):
        InpaintingNetwork(write(tmp_path / "one.onnx", inputs=1))


def test_a_result_of_another_shape_is_named(tmp_path):
    network = InpaintingNetwork(write(tmp_path / "last.onnx", channels_last=True))
    view = np.zeros((512, 512, 3), np.float32)
    with pytest.raises(ModelError, match="colors first"):
        network(view, np.zeros((512, 512), bool))


def test_the_method_and_the_file_go_together(tmp_path):
    with pytest.raises(ValueError, match="go together"):
        InpaintSettings(method="network")
    with pytest.raises(ValueError, match="go together"):
        InpaintSettings(network=tmp_path / "lama.onnx")
