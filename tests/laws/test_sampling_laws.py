"""However samples are shared out, each comes once, and a run goes on where it was."""

from itertools import chain

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from panokit.dataset.storage.sampling import ShardSampler
from panokit.errors import UsageError

SIZES = st.lists(st.integers(0, 40), max_size=12)
WORLDS = st.integers(1, 5)
NUMBERS = st.integers(0, 2**31)


def samplers(sizes, world, **options):
    return [ShardSampler(sizes, rank=rank, world=world, **options) for rank in range(world)]


def together(sizes, world, **options):
    """What all processes take, in the order in which they take it."""
    lists = [list(sampler) for sampler in samplers(sizes, world, **options)]
    longest = max(map(len, lists))
    return [one[i] for i in range(longest) for one in lists if i < len(one)]


@given(SIZES, WORLDS, NUMBERS, st.integers(0, 9), st.integers(1, 60))
def test_each_sample_comes_once_in_an_epoch(sizes, world, seed, epoch, window):
    options = {"seed": seed, "epoch": epoch, "window": window}
    taken = [list(sampler) for sampler in samplers(sizes, world, **options)]
    assert sorted(chain(*taken)) == list(range(sum(sizes)))
    assert max(map(len, taken)) - min(map(len, taken)) <= 1
    assert [len(sampler) for sampler in samplers(sizes, world, **options)] == [*map(len, taken)]


@given(SIZES, WORLDS, WORLDS, NUMBERS, st.integers(0, 200), st.integers(1, 60))
def test_a_run_goes_on_from_any_place_with_any_number_of_processes(
    sizes, world, later, seed, start, window
):
    options = {"seed": seed, "window": window}
    whole = together(sizes, world, **options)
    assert together(sizes, later, start=start, **options) == whole[start:]


@given(SIZES, WORLDS, NUMBERS, st.integers(0, 200))
def test_even_shares_are_equal_and_lack_less_than_a_round(sizes, world, seed, start):
    taken = [list(s) for s in samplers(sizes, world, seed=seed, start=start, even=True)]
    assert len({*map(len, taken)}) == 1
    left = max(0, sum(sizes) - start)
    assert left - world < sum(map(len, taken)) <= left


@given(SIZES, NUMBERS, st.integers(1, 30))
def test_samples_stay_within_their_window(sizes, seed, window):
    """What is read together lies together: a window holds few shards."""
    order = ShardSampler(sizes, seed=seed, window=window).order()
    shard_of = np.repeat(np.arange(len(sizes)), sizes)
    seen = [set(shard_of[order[i : i + window]]) for i in range(0, len(order), window)]
    for shard, size in enumerate(sizes):
        assert sum(shard in one for one in seen) <= size // window + 2


def test_epochs_and_seeds_have_orders_of_their_own():
    sizes = [50] * 4
    sampler = ShardSampler(sizes, seed=1)
    first = list(sampler)
    assert first == list(ShardSampler(sizes, seed=1))
    assert first != sorted(first)
    sampler.set_epoch(1)
    assert list(sampler) != first
    assert list(ShardSampler(sizes, seed=2)) != first
    sampler.set_epoch(0, start=190)
    assert list(sampler) == first[190:]


def test_a_window_as_large_as_all_mixes_all_shards():
    order = ShardSampler([100] * 10, seed=5, window=1000).order()
    assert len({number // 100 for number in order[:50]}) > 6


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"rank": 2, "world": 2}, "Rank 2 of 2"),
        ({"window": 0}, "Windows"),
        ({"start": -1}, "must not be negative"),
    ],
)
def test_wrong_arguments(options, text):
    with pytest.raises(UsageError, match=text):
        ShardSampler([3], **options)
