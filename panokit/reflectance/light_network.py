"""A network that reads light from two views: what it is given, and what it gives.

The evaluator and `panokit.lighting` both run models through this, so that what is measured is
what is used.
"""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.errors import ModelError, UsageError
from panokit.inference import DEFAULT_THREADS, Session
from panokit.reflectance.smaller import smaller_normals, smaller_picture
from panokit.reflectance.sparse import sparse_reflectance
from panokit.stereo import Views

TARGET_PX = 64
INPUTS = frozenset({"left", "right", "background", "maps", "map"})
TASK = "lighting"
# Kinds that give light; the others give reflectance.
LIGHT_KINDS = ("stereo", "dematerial")
Map = NDArray[np.float32]
# Takes normals (H, W, 3) and where there are any (H, W), and gives normals that are off.
NormalNoise = Callable[[NDArray[np.float32], NDArray[np.bool_]], NDArray[np.float32]]


class LightNetwork:
    """A model that reads light, or reflectance, from its folder; docs/formats.md says how.

    Args:
        folder: With model.toml and the network that it names.
        threads: As of `panokit.inference.Session`.
        device: As of `panokit.inference.Session`.

    Attributes:
        spec: The table [lighting] of its model.toml.
        kind: "stereo", "dematerial", "dense-reflectance" or "picture-reflectance".
        input_px: Width of the pictures that it reads; views of another size are resampled.

    Raises:
        ModelError: If the folder holds no such model.
    """

    def __init__(
        self, folder: Path, *, threads: int = DEFAULT_THREADS, device: str = "auto"
    ) -> None:
        self.folder = Path(folder)
        try:
            card = tomllib.loads((self.folder / "model.toml").read_text(encoding="utf-8"))
            self.spec: Mapping[str, Any] = card["lighting"]
            path = self.folder / str(card["files"]["lighting"]["name"])
            self.kind = str(self.spec["kind"])
            self.input_px, self._views = int(self.spec["input_px"]), str(self.spec["views"])
            self._materials = int(self.spec.get("materials", 1))
        except (OSError, tomllib.TOMLDecodeError, KeyError, ValueError, TypeError) as error:
            raise ModelError(
                f"{folder} is not a model that reads light from two views ({error!r}). "
                "Its model.toml needs the tables [lighting] and [files.lighting]."
            ) from error
        if not path.is_file():
            raise ModelError(f"There is no {path}, which its model.toml names. Train it again.")
        self.session = Session(path, threads=threads, device=device)
        unknown = set(self.session.inputs) - INPUTS
        if unknown:
            raise ModelError(f"{path} asks for {sorted(unknown)}, which views do not have.")

    @property
    def sees_both(self) -> bool:
        """Whether it looks at the right view at all."""
        return "right" in self.session.inputs

    @property
    def predicts_light(self) -> bool:
        """Whether it gives a map of light, not of reflectance."""
        return self.kind in LIGHT_KINDS

    def read(self, views: Views, noise: NormalNoise | None = None) -> Map:
        """The light: (64, 64, 3) linear radiance, anamorphic, in the left camera's frame.

        1.0 is the white of the pictures. Networks of reflectance give a dense map of that.

        Args:
            views: What to look at.
            noise: Spoils the normals, for models that were trained so.

        Raises:
            UsageError: If the views are not square, or have no normals where the model needs some.
            ModelError: If the model gives something else.
        """
        return self._run([self.inputs(views, noise)])[0]

    def read_all(self, several: Sequence[Views]) -> list[Map]:
        """The light of each of several views, in one run of the network; see `read`."""
        return self._run([self.inputs(views) for views in several])

    def _run(self, given: Sequence[Mapping[str, NDArray[np.float32]]]) -> list[Map]:
        found = self.session.run(
            {name: np.concatenate([one[name] for one in given]) for name in self.session.inputs}
        )
        radiance = np.asarray(next(iter(found.values())))
        if radiance.shape != (len(given), 3, TARGET_PX, TARGET_PX):
            raise ModelError(
                f"{self.folder.name} gives {radiance.shape[1:]}, not (3, {TARGET_PX}, {TARGET_PX})."
            )
        return [
            np.ascontiguousarray(np.maximum(one.transpose(1, 2, 0), 0), np.float32)
            for one in radiance
        ]

    def inputs(
        self, views: Views, noise: NormalNoise | None = None
    ) -> dict[str, NDArray[np.float32]]:
        """What the network is given: each of its inputs with a batch of one.

        Raises:
            UsageError: If the views are not square, or have no normals where the model needs some.
        """
        height, width = views.mask.shape
        if height != width:
            raise UsageError(f"Networks read square views, not {width}x{height}. Crop them.")
        # A network from a picture to reflectance sees no background either.
        on_background = self.kind == "stereo" and self._views == "composited"
        make: dict[str, Callable[[], NDArray[np.float32]]] = {
            "left": lambda: self._picture(views.left if on_background else views.left_object),
            "right": lambda: self._picture(views.right if on_background else views.right_object),
            "background": lambda: self._picture(views.background),
            "maps": lambda: self._maps(views, noise),
            "map": lambda: self._maps(views, noise),
        }
        return {name: make[name]() for name in self.session.inputs}

    def _picture(self, picture: NDArray[np.uint8]) -> NDArray[np.float32]:
        small = smaller_picture(picture, self.input_px)
        return np.ascontiguousarray(small.transpose(2, 0, 1)[None] / np.float32(255))

    def _maps(self, views: Views, noise: NormalNoise | None) -> NDArray[np.float32]:
        """Sparse reflectance maps by normals and materials, as in training."""
        picture = smaller_picture(views.left_object, self.input_px) / np.float32(255)
        size = (self.input_px, self.input_px)
        parts = np.asarray(cv2.resize(views.parts, size, interpolation=cv2.INTER_NEAREST))
        normals = smaller_normals(views.normals, self.input_px)
        seen = (parts > 0) & (np.abs(normals).sum(axis=-1) > 0)
        if (parts > 0).any() and not seen.any():
            raise UsageError(
                f"{self.folder.name} reads reflectance maps, which need normals, and these views "
                "have none. Take a model that reads pictures alone."
            )
        if noise is not None:
            normals = noise(normals, seen)
        if self.kind == "dense-reflectance":
            masks = [seen & (parts == 1)]
        elif self._materials == 1:
            masks = [seen]
        else:
            masks = [seen & (parts == number + 1) for number in range(self._materials)]
        channels = []
        for mask in masks:
            found = sparse_reflectance(picture, normals, mask)
            channels += [found.color.transpose(2, 0, 1), found.valid[None].astype(np.float32)]
        return np.concatenate(channels)[None]
