"""What happened in training, step by step: JSON lines always, TensorBoard where it is installed."""

import json
import time
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from panokit.io.files import write_bytes

FILE, BOARD = "history.jsonl", "tensorboard"
NOTE_EVERY = 10


class History:
    """The log of one network's training, in a file that it shares with the others' of a run.

    A run that goes on from a checkpoint drops what was written after that checkpoint, so each
    step is there once.

    Args:
        folder: Of the run; gets `history.jsonl` and, where TensorBoard is installed,
            `tensorboard/`. Nothing is written if not given.
        network: Whose training it is, such as "gain-0".
        from_step: That training starts or goes on at.
    """

    def __init__(self, folder: Path | None, network: str, from_step: int = 0) -> None:
        self._path = None if folder is None else folder / FILE
        self._network = network
        self._board: Any = None
        self._start = time.monotonic()
        if folder is None or self._path is None:
            return
        folder.mkdir(parents=True, exist_ok=True)
        self._forget(from_step)
        if find_spec("tensorboard") is not None:
            # It takes a second to load, and nobody else needs it.
            from torch.utils.tensorboard import SummaryWriter

            place = folder / BOARD / network
            self._board = SummaryWriter(str(place), purge_step=from_step)

    def note(self, step: int, losses: Mapping[str, float], learning_rate: float) -> None:
        """Add a line.

        Args:
            step: How many steps were done.
            losses: The terms of the loss by name, and "loss", their sum.
            learning_rate: That the step was made with.
        """
        if self._path is None:
            return
        line = {
            "network": self._network,
            "step": step,
            **{name: round(value, 6) for name, value in losses.items()},
            "learning_rate": learning_rate,
            "seconds": round(time.monotonic() - self._start, 3),
        }
        with self._path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")
        if self._board is not None:
            for name, value in (*losses.items(), ("learning_rate", learning_rate)):
                self._board.add_scalar(name, value, step)

    def close(self) -> None:
        """Write what TensorBoard still holds back."""
        if self._board is not None:
            self._board.close()

    def _forget(self, from_step: int) -> None:
        """Drop this network's lines beyond a step, and a last line that was cut off."""
        if self._path is None or not self._path.exists():
            return
        kept = []
        for text in self._path.read_text(encoding="utf-8").splitlines():
            try:
                line = json.loads(text)
            except json.JSONDecodeError:
                continue
            if line["network"] != self._network or line["step"] <= from_step:
                kept.append(text)
        write_bytes(self._path, "".join(f"{text}\n" for text in kept).encode())
