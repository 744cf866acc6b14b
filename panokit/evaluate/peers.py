"""Other people's methods as columns of the table: any ONNX file, any command.

An ONNX file takes one picture and gives one: the input is float32, RGB, sRGB-encoded in
[0, 1], of shape (1, 3, H, W) or (1, H, W, 3), with free or fixed height and width; the first
output has the same layout and is linear radiance, of any scale (the protocol aligns it).
Where height and width are fixed, the picture is resized for it and the answer back.

A command gets the path of a PNG and writes an EXR (or .hdr) at another path, linear, of any
size with the picture's shape of 2:1. `{input}` and `{output}` in it stand for the two; without
them they are added at its end.
"""

import shlex
import subprocess
import tempfile
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.errors import ItemError, ModelError, UsageError
from panokit.evaluate.predictors import (
    FOLD,
    PER_FOLD,
    Method,
    file_digest,
    first_of,
    is_for_fold,
    model_method,
    seen_digests,
)
from panokit.evaluate.probe_set import ListedProbe
from panokit.inference import Session
from panokit.io import read_environment_map
from panokit.io.files import write_bytes
from panokit.io.images import encode_png
from panokit.provenance import digest_of
from panokit.sphere import resize_radiance
from panokit.weights import find_model

# A released network that takes a picture and gives one, and is no model of panokit's own kind.
BASELINE_TASK = "expand-baseline"
MODEL_CARD = "model.toml"
_TOLD = 300


@dataclass(frozen=True, slots=True, kw_only=True)
class OnnxPredictor:
    """An ONNX file.

    Attributes:
        digest: Of the file.
        session: Loaded.
        seen: SHA-256 of the probes that a training.json beside it lists, or None.
    """

    digest: str
    session: Session
    seen: frozenset[str] | None

    def predict(self, pixels: NDArray[np.uint8]) -> NDArray[np.float32]:
        """See `panokit.evaluate.predictors.Predictor`."""
        shape = self.session.input_shapes[0]
        is_last = shape[-1] == 3 and shape[1] != 3
        height, width = shape[1:3] if is_last else shape[2:4]
        picture: NDArray[np.float32] = pixels.astype(np.float32) / np.float32(255)
        if height is not None and width is not None:
            resized = cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA)
            picture = np.asarray(resized, np.float32)
        batch = picture[None] if is_last else picture.transpose(2, 0, 1)[None]
        answer = self.session.run({self.session.inputs[0]: batch})[self.session.outputs[0]]
        if answer.shape != batch.shape:
            raise ModelError(
                f"The network gave {answer.shape} for {batch.shape}; an expansion gives a "
                "picture of the input's shape. See docs/commands/evaluate.md."
            )
        light = np.maximum(answer[0] if is_last else answer[0].transpose(1, 2, 0), 0)
        return _at_size(np.ascontiguousarray(light, np.float32), pixels.shape[:2])

    def has_seen(self, probe: ListedProbe) -> bool | None:
        """By the training.json beside the file."""
        return None if self.seen is None else probe.sha256 in self.seen


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandPredictor:
    """A command of the user's.

    Attributes:
        words: Of the command.
        timeout_s: For one picture.
    """

    words: tuple[str, ...]
    timeout_s: float

    @property
    def digest(self) -> str:
        """Of the command line; what it runs may change behind it."""
        return digest_of(["command", *self.words])

    def predict(self, pixels: NDArray[np.uint8]) -> NDArray[np.float32]:
        """See `panokit.evaluate.predictors.Predictor`.

        Raises:
            ItemError: If the command fails on this picture, or writes no map.
        """
        with tempfile.TemporaryDirectory(prefix="panokit-") as folder:
            source, target = Path(folder, "input.png"), Path(folder, "output.exr")
            write_bytes(source, encode_png(pixels))
            words = [w.replace("{input}", str(source)).replace("{output}", str(target))
                     for w in self.words]  # fmt: skip
            self._run(words)
            if not target.is_file():
                raise ItemError(
                    f"{self.words[0]} ended well but wrote no {{output}}. It must write an EXR "
                    "at the path that it is given.",
                    reason="no-output",
                )
            return _at_size(read_environment_map(target).radiance, pixels.shape[:2])

    def has_seen(self, probe: ListedProbe) -> bool | None:
        """Nobody says."""
        return None

    def _run(self, words: list[str]) -> None:
        try:
            done = subprocess.run(
                words, capture_output=True, timeout=self.timeout_s, check=False, text=True
            )
        except OSError as error:
            raise UsageError(
                f"Cannot run {words[0]}: {error.strerror}. Check the --peer."
            ) from error
        except subprocess.TimeoutExpired as error:
            raise ItemError(
                f"{words[0]} took longer than {self.timeout_s:g} s. Raise --timeout-s.",
                reason="timeout",
            ) from error
        if done.returncode:
            said = " ".join((done.stderr or done.stdout).split())[-_TOLD:]
            raise ItemError(
                f"{words[0]} failed with code {done.returncode}: {said or 'it said nothing'}",
                reason="command-failed",
            )


def method_of(where: str) -> Method:
    """A model by its id, its folder, or its .onnx file; with {fold}, one for each fold.

    Raises:
        ModelError: If there is none, or it is damaged, or no expansion.
    """
    if where.endswith(".onnx"):
        return onnx_method(where)
    if FOLD not in where and not Path(where, MODEL_CARD).is_file():
        model = find_model(where)
        if model.task == BASELINE_TASK:
            return onnx_method(model.path("network"))
    return model_method(where)


def onnx_method(where: Path | str) -> Method:
    """An ONNX file as a column named like the file, or a pattern with {fold} for one each.

    Raises:
        ModelError: If it cannot be loaded, or does not take one RGB picture.
    """
    pattern = str(where)
    # One at a time: a network at full size keeps gigabytes of scratch memory.
    load = lru_cache(maxsize=1)(lambda place: _onnx_predictor(Path(place)))
    load(first_of(pattern, ""))
    return Method(
        name=Path(pattern).stem.replace(FOLD, "") + (PER_FOLD if FOLD in pattern else ""),
        predictor=lambda fold: load(pattern.replace(FOLD, str(fold))),
        has_fold=partial(is_for_fold, pattern, ""),
    )


def _onnx_predictor(path: Path) -> OnnxPredictor:
    session = Session(path, threads=1, device="cpu")
    shapes = session.input_shapes
    fits = len(shapes) == 1 and len(shapes[0]) == 4 and 3 in (shapes[0][1], shapes[0][-1])
    if not fits:
        raise ModelError(
            f"{path} takes inputs of shape {[list(shape) for shape in shapes]}; a peer takes one "
            "RGB picture, (1, 3, H, W) or (1, H, W, 3). See docs/commands/evaluate.md."
        )
    return OnnxPredictor(digest=file_digest(path), session=session, seen=seen_digests(path.parent))


def peer_method(text: str, timeout_s: float) -> Method:
    """Somebody else's method: an .onnx file (see `onnx_method`) or a command.

    Raises:
        ModelError: If the file is no network of a picture.
        UsageError: If there is no command in the text.
    """
    return onnx_method(text) if text.endswith(".onnx") else command_method(text, timeout_s)


def command_method(text: str, timeout_s: float) -> Method:
    """A command as a column: "NAME=COMMAND", or a command, named by its program.

    Raises:
        UsageError: If there is no command in it.
    """
    name, equals, rest = text.partition("=")
    if not equals or not name.replace("-", "").replace("_", "").replace(".", "").isalnum():
        name, rest = "", text
    try:
        words = shlex.split(rest)
    except ValueError as error:
        raise UsageError(f"--peer {text!r} is not a command line: {error}.") from error
    if not words:
        raise UsageError("--peer takes an .onnx file, or NAME=PROGRAM ARGUMENTS {input} {output}.")
    if not any("{input}" in word or "{output}" in word for word in words):
        words += ["{input}", "{output}"]
    predictor = CommandPredictor(words=tuple(words), timeout_s=timeout_s)
    return Method(name=name or Path(words[0]).stem, predictor=lambda fold: predictor)


def _at_size(light: NDArray[np.float32], shape: tuple[int, ...]) -> NDArray[np.float32]:
    height, width = shape[:2]
    if light.shape[:2] == (height, width):
        return light
    if light.shape[1] == 2 * light.shape[0]:
        return resize_radiance(light, width)
    raise ItemError(
        f"The answer is {light.shape[1]}x{light.shape[0]}, not 2:1 like the picture.",
        reason="wrong-size",
    )
