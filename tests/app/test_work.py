"""Long work: elsewhere, and its errors in words."""

import asyncio
import os

import pytest

from panokit.app.work import Work, in_words
from panokit.errors import ImageError, MissingExtraError, PanokitError


def fail_on(picture):
    raise ImageError(f"{picture} is no panorama. Drop another.", reason="not-equirectangular")


def miss():
    raise MissingExtraError("mitsuba", "render", "Rendering")


def die():
    os._exit(9)


def pid():
    return os.getpid()


@pytest.fixture(scope="module")
def work():
    work = Work()
    yield work
    work.close()


def test_errors_come_back_as_they_are(work):
    async def run():
        with pytest.raises(ImageError, match=r"a\.jpg is no panorama") as found:
            await work.in_process(fail_on, "a.jpg")
        assert found.value.reason == "not-equirectangular"
        with pytest.raises(PanokitError, match=r"panokit\[render\]"):
            await work.in_process(miss)

    asyncio.run(run())


def test_a_worker_that_dies_is_told_and_replaced(work):
    async def run():
        before = await work.in_process(pid)
        assert before != os.getpid()
        with pytest.raises(PanokitError, match="memory"):
            await work.in_process(die)
        assert await work.in_process(pid) != before

    asyncio.run(run())


def test_threads_share_the_process(work):
    assert asyncio.run(work.in_thread(pid)) == os.getpid()


def test_words_for_every_error(caplog):
    assert in_words(ImageError("It is black. Take another.")) == "It is black. Take another."
    kept = "/tmp/panokit-app-x1y2/ab12/inbox/alone/a.jpg: no panorama. See /home/me/b.jpg."
    assert in_words(ImageError(kept)) == "a.jpg: no panorama. See /home/me/b.jpg."
    assert "memory" in in_words(MemoryError())
    assert not caplog.records
    assert "KeyError" in in_words(KeyError("x"))
    assert caplog.records
