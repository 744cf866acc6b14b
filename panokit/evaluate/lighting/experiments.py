"""The experiments of the suite by name: what they are called, and where the thesis has them."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

Group = Literal["stereo", "panokit", "reflectance map", "augmented", "reflectance", "baseline"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Experiment:
    """One line of the suite.

    Attributes:
        title: In figures.
        group: What it belongs to.
        thesis: Its number in the list of chapter 4.3 or section, "" for what is not there.
    """

    title: str
    group: Group
    thesis: str = ""


def _stereo(title: str, thesis: str = "") -> Experiment:
    return Experiment(title=title, group="stereo", thesis=thesis)


def _maps(title: str, thesis: str = "3.2") -> Experiment:
    return Experiment(title=title, group="reflectance map", thesis=thesis)


def _augmented(title: str, thesis: str = "") -> Experiment:
    return Experiment(title=title, group="augmented", thesis=thesis)


def _reflectance(title: str) -> Experiment:
    return Experiment(title=title, group="reflectance", thesis="3.1")


EXPERIMENTS: Mapping[str, Experiment] = MappingProxyType(
    {
        "concat-unshared-deep": _stereo("concat, unshared, deep", "STR-1"),
        "concat-shared-deep": _stereo("concat, shared, deep", "STR-2"),
        "dot-product-deep": _stereo("dot product, deep", "STR-3"),
        "concat-shared": _stereo("concat, shared", "STR-2"),
        "dot-product": _stereo("dot product", "STR-3"),
        "copy-left": _stereo("dot product, left copied", "STR-2"),
        "no-background": _stereo("without background", "STR-4"),
        "background-branch": _stereo("own background branch", "STR-6"),
        "pyramid": _stereo("similarity pyramid", "STR-7"),
        "pyramid-multi-scale": _stereo("pyramid, multi-scale", "STR-8"),
        "epipolar": _stereo("epipolar similarity"),
        "panokit": Experiment(title="panokit", group="panokit"),
        "panokit-no-window": Experiment(title="panokit, background elsewhere", group="panokit"),
        "dematerial": _maps("Dematerial, true normals"),
        "dematerial-noise-10": _maps("Dematerial, normals off by 10°"),
        "dematerial-noise-20": _maps("Dematerial, normals off by 20°"),
        "dematerial-noise-30": _maps("Dematerial, normals off by 30°"),
        "dematerial-3": _maps("Dematerial, three materials"),
        "augmented-reference": _augmented("reference probes alone", "STR-5"),
        "augmented-expanded": _augmented("with expanded panoramas", "STR-5"),
        "augmented-linearized": _augmented("with linearized panoramas", "STR-5"),
        "augmented-reference-panokit": _augmented("panokit, reference probes alone"),
        "augmented-expanded-panokit": _augmented("panokit, with expanded panoramas"),
        "augmented-linearized-panokit": _augmented("panokit, with linearized panoramas"),
        "dense-reflectance": _reflectance("sparse to dense, true normals"),
        "dense-reflectance-noise-10": _reflectance("sparse to dense, off by 10°"),
        "dense-reflectance-noise-20": _reflectance("sparse to dense, off by 20°"),
        "dense-reflectance-noise-30": _reflectance("sparse to dense, off by 30°"),
        "picture-reflectance": _reflectance("picture to dense, end to end"),
    }
)
# The thesis's final model, STR-10, and what the normal-noise curves are held against.
FINAL = "background-branch"
# The model that was built to win.
OWN = "panokit"
# What figures of single models show, as far as it is there.
FEATURED = (OWN, FINAL, "dematerial", "mean map")


def experiment(name: str, kind: str = "stereo") -> Experiment:
    """The experiment with a name, or one that is named after itself.

    Args:
        name: Of the experiment.
        kind: Of its model, for those that are not of the suite.
    """
    if name in EXPERIMENTS:
        return EXPERIMENTS[name]
    groups: dict[str, Group] = {
        "stereo": "stereo", "dematerial": "reflectance map", "dense-reflectance": "reflectance",
        "picture-reflectance": "reflectance",
    }  # fmt: skip
    return Experiment(title=name, group=groups.get(kind, "baseline"))


def order_of(name: str) -> int:
    """Where an experiment stands in tables; those that are not of the suite come last."""
    names = list(EXPERIMENTS)
    return names.index(name) if name in names else len(names)
