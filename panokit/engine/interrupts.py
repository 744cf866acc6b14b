"""Ctrl-C reaches every process of a terminal, and one alone is to answer: the driver.

A process that starts has no time to say so: Python would end it in the middle of its imports, with
a traceback. So it is born with the signal held back, and lets go once it ignores it.
"""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker


@contextmanager
def interrupts_held_back() -> Iterator[None]:
    """Hold Ctrl-C back; whoever is started in this block holds it back from its first moment."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    # Where it first starts within the block, it would let go of the signal.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def leave_interrupts_to_driver() -> None:
    """Ignore Ctrl-C from now on: whoever has started this process hears it too, and ends it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
