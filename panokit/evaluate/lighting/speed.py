"""How fast and how large a network is: latency, operations, parameters, memory.

Measured through ONNX Runtime in a process of its own, so that memory is the network's and
nothing else's. Operations are counted from the shapes that ONNX Runtime reports of each node: a
multiplication with its addition counts as two.
"""

import json
import os
import platform
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.errors import ModelError
from panokit.evaluate.lighting.models import ModelFacts
from panokit.inference import DEFAULT_THREADS, Session, profile_nodes, runtime_version

_WARM_RUNS, _RUNS = 10, 100
_MOST_SECONDS = 20.0
_TIMEOUT_S = 300.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Speed:
    """Of one network with a batch of one.

    Attributes:
        p50_ms: Median latency.
        p95_ms: Of 95 % of the runs no more than that.
        cpu_ms: Mean time of all processors together, which a busy machine does not change.
        fps: Pairs a second, 1000 / `p50_ms`.
        runs: That were timed.
        gflops: Billion operations for a pair.
        parameters: Numbers in the file.
        file_mb: Of the network.
        memory_mb: The process's peak with the network, over that without.
        hardware: What it was measured on.
    """

    p50_ms: float
    p95_ms: float
    cpu_ms: float
    fps: float
    runs: int
    gflops: float
    parameters: int
    file_mb: float
    memory_mb: float
    hardware: str

    def to_json(self) -> dict[str, float | int | str]:
        """A dictionary for `json.dump`."""
        return asdict(self)


def measure_speed(facts: ModelFacts, *, device: str = "auto") -> Speed:
    """Measure a model in a process of its own.

    Raises:
        ModelError: If it does not run.
    """
    path = facts.folder / facts.file
    command = [sys.executable, "-m", "panokit.evaluate.lighting.speed", str(path), device]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, check=False, timeout=_TIMEOUT_S
        )
    except subprocess.TimeoutExpired as error:
        raise ModelError(f"{path} took longer than {_TIMEOUT_S:g} s to be measured.") from error
    if done.returncode:
        said = (done.stderr.strip().splitlines() or ["it said nothing"])[-1]
        raise ModelError(f"{path} cannot be measured: {said}")
    return Speed(**json.loads(done.stdout.splitlines()[-1]))


def measure_here(path: Path, device: str = "auto") -> Speed:
    """Measure a network in this process; its memory is that of all that is loaded here."""
    before = _peak_mb()
    session = Session(path, device=device)
    inputs = _inputs(session)
    for _ in range(_WARM_RUNS):
        session.run(inputs)
    times: list[float] = []
    began, cpu = time.perf_counter(), time.process_time()
    while len(times) < _RUNS and time.perf_counter() - began < _MOST_SECONDS:
        started = time.perf_counter()
        session.run(inputs)
        times.append(time.perf_counter() - started)
    cpu_ms = 1000 * (time.process_time() - cpu) / len(times)
    memory = _peak_mb() - before
    p50, p95 = (1000 * float(value) for value in np.percentile(times, [50, 95]))
    operations, parameters = count_operations(path, inputs)
    return Speed(
        p50_ms=round(p50, 3),
        p95_ms=round(p95, 3),
        cpu_ms=round(cpu_ms, 3),
        fps=round(1000 / p50, 1),
        runs=len(times),
        gflops=round(operations / 1e9, 4),
        parameters=parameters,
        file_mb=round(path.stat().st_size / 1e6, 3),
        memory_mb=round(memory, 1),
        hardware=hardware(session.device),
    )


def count_operations(path: Path, inputs: Mapping[str, NDArray[np.float32]]) -> tuple[int, int]:
    """Operations of one run, and how many parameters the network has."""
    nodes = profile_nodes(path, inputs)
    operations = sum(_operations(told) for told in nodes)
    return operations, sum(int(told.get("parameter_size", 0)) // 4 for told in nodes)


def _operations(told: Mapping[str, Any]) -> int:
    """Of one node, by its kind and shapes."""
    shapes = [next(iter(one.values())) for one in told["input_type_shape"]]
    out = (
        prod(next(iter(told["output_type_shape"][0].values()))) if told["output_type_shape"] else 0
    )
    kind = told["op_name"]
    if kind == "Conv":
        return 2 * out * prod(shapes[1][1:])
    if kind == "ConvTranspose":
        return 2 * prod(shapes[0]) * prod(shapes[1][1:])
    if kind in ("MatMul", "Gemm"):
        return 2 * out * int(shapes[0][-1])
    if kind in ("MaxPool", "AveragePool", "ReduceSum", "ReduceMean"):
        return prod(shapes[0])
    return out if kind in _PER_VALUE else 0


_PER_VALUE = frozenset(
    {"Add", "Sub", "Mul", "Div", "Relu", "LeakyRelu", "Pow", "Sqrt", "Exp", "Log", "Max", "Min",
     "Clip", "Sigmoid", "Tanh", "Where", "BatchNormalization"}
)  # fmt: skip


def _inputs(session: Session) -> dict[str, NDArray[np.float32]]:
    rng = np.random.default_rng(0)
    return {
        name: rng.random([length or 1 for length in shape], dtype=np.float32)
        for name, shape in zip(session.inputs, session.input_shapes, strict=True)
    }


def hardware(device: str) -> str:
    """What this machine computes on, in a line."""
    name = platform.processor() or platform.machine()
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        name = next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    threads = min(DEFAULT_THREADS, os.cpu_count() or 1)
    return f"{device}, {threads} threads of {name}, ONNX Runtime {runtime_version()}"


def _peak_mb() -> float:
    """The most memory that this process has held."""
    try:
        # Unlike getrusage, it does not count the process that started this one.
        lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
        return int(next(line for line in lines if line.startswith("VmHWM")).split()[1]) / 1024
    except (OSError, StopIteration):
        import resource

        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return peak / (1 << 20 if sys.platform == "darwin" else 1 << 10)


if __name__ == "__main__":
    sys.stdout.write(json.dumps(measure_here(Path(sys.argv[1]), sys.argv[2]).to_json()) + "\n")
