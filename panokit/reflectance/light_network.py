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
from panokit.reflectance.materials import segment_materials
from panokit.reflectance.sparse import sparse_reflectance
from panokit.stereo import Views

TARGET_PX = 64
INPUTS = ("left", "right", "background", "maps")


class LightNetwork:
    """A model that reads light, from its folder; see docs/formats.md for what goes in.

    Args:
        folder: With model.toml and the network that it names.
        threads: As of `panokit.inference.Session`.
        device: As of `panokit.inference.Session`.

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
            file = card["files"]["lighting"]["name"]
            self._size, self._views = int(self.spec["input_px"]), str(self.spec["views"])
            self._materials = int(self.spec.get("materials", 1))
        except (OSError, tomllib.TOMLDecodeError, KeyError, ValueError, TypeError) as error:
            raise ModelError(
                f"{folder} is not a model that reads light from two views ({error!r}). "
                "Its model.toml needs the tables [lighting] and [files.lighting]."
            ) from error
        self.session = Session(self.folder / file, threads=threads, device=device)
        unknown = set(self.session.inputs) - set(INPUTS)
        if unknown:
            raise ModelError(f"{folder} asks for {sorted(unknown)}, which views do not have.")

    @property
    def sees_both(self) -> bool:
        """Whether it looks at the right view at all."""
        return "right" in self.session.inputs

    def read(self, views: Views) -> NDArray[np.float32]:
        """The light: (64, 64, 3) linear radiance, anamorphic, in the left camera's frame.

        1.0 is the white of the pictures.

        Raises:
            UsageError: If the model needs normals and the views have none.
            ModelError: If the model gives something else.
        """
        return self.read_all([views])[0]

    def read_all(self, several: Sequence[Views]) -> list[NDArray[np.float32]]:
        """The light of each of several views, in one run of the network; see `read`."""
        given = [self.inputs(views) for views in several]
        found = self.session.run(
            {name: np.concatenate([one[name] for one in given]) for name in self.session.inputs}
        )
        radiance = np.asarray(next(iter(found.values())))
        if radiance.shape != (len(several), 3, TARGET_PX, TARGET_PX):
            raise ModelError(
                f"{self.folder.name} gives {radiance.shape[1:]}, not (3, {TARGET_PX}, {TARGET_PX})."
            )
        return [
            np.ascontiguousarray(np.maximum(one.transpose(1, 2, 0), 0), np.float32)
            for one in radiance
        ]

    def inputs(self, views: Views) -> dict[str, NDArray[np.float32]]:
        """What the network is given: each of its inputs with a batch of one."""
        on_background = self._views == "composited"
        make: dict[str, Callable[[], NDArray[np.float32]]] = {
            "left": lambda: self._picture(views.left if on_background else views.left_object),
            "right": lambda: self._picture(views.right if on_background else views.right_object),
            "background": lambda: self._picture(views.background),
            "maps": lambda: self._maps(views),
        }
        return {name: make[name]() for name in self.session.inputs}

    def _picture(self, picture: NDArray[np.uint8]) -> NDArray[np.float32]:
        size = (self._size, self._size)
        if picture.shape[:2] != size:
            picture = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8)
        return np.ascontiguousarray(picture.transpose(2, 0, 1)[None] / np.float32(255))

    def _maps(self, views: Views) -> NDArray[np.float32]:
        """Sparse reflectance maps by the normals, of as many materials as there are inputs."""
        picture = views.left_object / np.float32(255)
        seen = views.mask & (np.abs(views.normals).sum(axis=-1) > 0)
        if views.mask.any() and not seen.any():
            raise UsageError(
                f"{self.folder.name} reads reflectance maps, which need normals, and these views "
                "have none. Take a model that reads pictures alone."
            )
        masks = [seen]
        if self._materials > 1:
            part = segment_materials(picture, seen, self._materials)
            masks = [part == number for number in range(1, self._materials + 1)]
        channels = []
        for mask in masks:
            found = sparse_reflectance(picture, views.normals, mask)
            channels += [found.color.transpose(2, 0, 1), found.valid[None].astype(np.float32)]
        return np.concatenate(channels)[None]
