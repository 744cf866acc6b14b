"""What engines cost: scheduling overhead, idle cores and memory, as ratios within one run.

    python tests/benchmarks/engine_overhead.py [--engines local,dask] [--seconds 10]

Overhead: tasks that sleep for 200 ms, against as many sleeps in plain processes.
Idle cores: tasks that compute for 200 ms each, in CPU-seconds per wall-second while all workers
are at work, against plain processes that compute all the time, just before and just after.
Memory: the largest a worker was, and the largest the driver was.
"""

import argparse
import multiprocessing
import os
import resource
import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from pathlib import Path

from panokit.engine import Engine, make_engine
from panokit.records import Receipt

WORKERS = 2
TASK_S = 0.2


def sleep_task(item: int) -> Receipt:
    """A task that needs no core."""
    return _timed(item, lambda: time.sleep(TASK_S))


def busy_task(item: int) -> Receipt:
    """A task that needs so much of a core, however long it takes to get it."""
    return _timed(item, lambda: _spin(TASK_S))


def _timed(item: int, work: Callable[[], None]) -> Receipt:
    begun, cpu = time.monotonic(), time.thread_time()
    work()
    values = {
        "worker": os.getpid(),
        "begun": begun,
        "ended": time.monotonic(),
        "cpu_s": time.thread_time() - cpu,
        "mb": _largest_mb(),
    }
    return Receipt(item=str(item), stage="bench", path=Path(str(item)), key="", values=values)


def _spin(cpu_s: float) -> None:
    end = time.thread_time() + cpu_s
    while time.thread_time() < end:
        sum(range(2000))


def _largest_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def _together(outcomes: Sequence[Receipt]) -> tuple[float, float, int]:
    """Seconds while all workers were at work, the CPU-seconds and the tasks that fell in them.

    Clocks are the system's, so those of two processes agree.
    """
    by_worker = defaultdict(list)
    for outcome in outcomes:
        by_worker[outcome.values["worker"]].append(outcome.values)
    begin = max(min(v["begun"] for v in values) for values in by_worker.values())
    end = min(max(v["ended"] for v in values) for values in by_worker.values())
    cpu_s = tasks = 0.0
    for outcome in outcomes:
        v = outcome.values
        share = (min(v["ended"], end) - max(v["begun"], begin)) / (v["ended"] - v["begun"])
        cpu_s += v["cpu_s"] * max(share, 0.0)
        tasks += max(share, 0.0)
    assert len(by_worker) == WORKERS, "one worker did it all: give it more to do"
    return end - begin, cpu_s, tasks


def _plain(task: Callable[[int], Receipt], count: int) -> list[Receipt]:
    """The same tasks in plain processes, one after the other and nothing in between."""
    context = multiprocessing.get_context("fork")
    queue = context.SimpleQueue()

    def loop() -> None:
        for item in range(count // WORKERS):
            queue.put(task(item))

    processes = [context.Process(target=loop) for _ in range(WORKERS)]
    for process in processes:
        process.start()
    found = [queue.get() for _ in range(count // WORKERS * WORKERS)]
    for process in processes:
        process.join()
    return found


def _driven(
    engine: Engine, task: Callable[[int], Receipt], count: int
) -> tuple[list[Receipt], float]:
    """The outcomes, and the driver's CPU-seconds for each once the workers are there."""
    running = engine.run(task, range(count))
    outcomes = [next(running)]
    cpu = time.process_time()
    outcomes += running
    return outcomes, (time.process_time() - cpu) / (count - 1)


def _rate(outcomes: Sequence[Receipt]) -> float:
    seconds, _, tasks = _together(outcomes)
    return tasks / seconds


def _busy(outcomes: Sequence[Receipt]) -> float:
    seconds, cpu_s, _ = _together(outcomes)
    return cpu_s / seconds


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--engines", default="local,dask")
    parser.add_argument("--seconds", type=float, default=10.0, help="CPU time of each part")
    options = parser.parse_args()
    count = int(options.seconds / TASK_S) * WORKERS
    print(
        f"{count} tasks of {TASK_S * 1000:.0f} ms, {WORKERS} workers, load {os.getloadavg()[0]:.1f}"
    )
    for name in options.engines.split(","):
        engine = make_engine(name, WORKERS)
        try:
            measured = {}
            for task, rate in ((sleep_task, _rate), (busy_task, _busy)):
                before = rate(_plain(task, count))
                outcomes, driver_s = _driven(engine, task, count)
                after = rate(_plain(task, count))
                measured[task] = rate(outcomes), before, after, driver_s, outcomes
        finally:
            engine.close()
        own, before, after, driver_s, _ = measured[sleep_task]
        print(f"\n{name}")
        print(
            f"  overhead of {TASK_S * 1000:.0f} ms tasks: {(before + after) / 2 / own - 1:+.1%} "
            f"(tasks/s {own:.2f}; plain {before:.2f} and {after:.2f}); goal < 5 %"
        )
        print(f"  driver: {driver_s * 1000:.1f} ms of CPU for each task")
        own, before, after, _, outcomes = measured[busy_task]
        print(
            f"  CPU-s per wall-s: {own:.2f}; plain loops {before:.2f} and {after:.2f}; "
            f"ratio {own / ((before + after) / 2):.2f}; goal >= 0.9"
        )
        workers = max(outcome.values["mb"] for outcome in outcomes)
        print(
            f"  memory: {workers:.0f} MB for each worker, {_largest_mb():.0f} MB for the driver",
            flush=True,
        )


if __name__ == "__main__":
    main()
