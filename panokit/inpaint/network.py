"""An inpainting network of the user's, such as LaMa exported to ONNX.

The file takes two inputs and gives one output, in this order and whatever their names:

    image   (1, 3, 512, 512) float32, RGB, 0 to 1, sRGB-encoded
    mask    (1, 1, 512, 512) float32, 1 where to fill, 0 where the picture is known
    result  (1, 3, 512, 512) float32, RGB, 0 to 1 or 0 to 255

It sees the flat view around the hole. Of an HDR map it sees the logarithm, cut at white.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panokit.errors import ModelError, UsageError
from panokit.inference import Session

_ZERO_TO_ONE = 1.5


class InpaintingNetwork:
    """A network ready to fill views.

    Args:
        path: Of the .onnx file.

    Raises:
        UsageError: If there is no such file.
        ModelError: If it is not a network with two inputs.
    """

    def __init__(self, path: Path) -> None:
        if not path.is_file():
            raise UsageError(f"There is no {path}. --network takes an inpainting network, .onnx.")
        self._session = Session(path)
        if len(self._session.inputs) != 2:
            raise ModelError(
                f"{path.name} takes {list(self._session.inputs)}; an inpainting network takes an "
                "image and a mask. See docs/commands/inpaint.md."
            )

    def __call__(
        self, view: NDArray[np.float32], unknown: NDArray[np.bool_]
    ) -> NDArray[np.float32]:
        """The view filled.

        Args:
            view: (512, 512, 3) float32, in gray levels.
            unknown: (512, 512) bool.

        Raises:
            ModelError: If the network does not take or give what it should.
        """
        image, mask = self._session.inputs
        results = self._session.run(
            {
                image: np.moveaxis(np.clip(view / np.float32(255), 0, 1), -1, 0)[None].astype(
                    np.float32
                ),
                mask: unknown.astype(np.float32)[None, None],
            }
        )
        result = results[self._session.outputs[0]]
        wanted = (1, 3, *view.shape[:2])
        if result.shape != wanted:
            raise ModelError(
                f"The inpainting network gave {result.shape}, not {wanted}. Export it for "
                f"{view.shape[1]}x{view.shape[0]} pixels with the colors first."
            )
        scale = 255.0 if result.max() <= _ZERO_TO_ONE else 1.0
        return np.asarray(np.moveaxis(result[0], 0, -1) * np.float32(scale), np.float32)
