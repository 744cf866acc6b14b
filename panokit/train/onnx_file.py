"""ONNX files that hold the network and nothing of the machine that made it."""

from typing import Any


def without_traces(model: Any) -> Any:
    """The same ONNX model without the exporter's stack traces, which name files of its maker.

    Args:
        model: An onnx.ModelProto; changed in place.
    """
    graphs = [model.graph, *model.functions]
    del model.metadata_props[:]
    while graphs:
        graph = graphs.pop()
        del graph.metadata_props[:]
        for name in ("input", "output", "value_info", "initializer"):
            for value in getattr(graph, name, ()):
                if hasattr(value, "metadata_props"):
                    del value.metadata_props[:]
        for node in graph.node:
            del node.metadata_props[:]
            node.doc_string = ""
            graphs += [a.g for a in node.attribute if a.HasField("g")]
    return model
