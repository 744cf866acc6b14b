"""Which places and objects belong to training, validation and test: never to two of them.

What shows one place, or is equal by content, is one group, and a group is in one split. A
group's split depends on its own name and the seed, so that a library which grows keeps the
splits of what it had.
"""

import hashlib
from collections.abc import Iterable, Mapping, Sequence

from panokit.dataset.sample import SPLITS
from panokit.dataset.settings import DatasetSettings
from panokit.errors import UsageError

_GOLDEN = 0.6180339887498949


def split_of_index(settings: DatasetSettings, index: int) -> str:
    """The split that sample `index` belongs to.

    The shares are met as closely as whole samples can, in every run of indices: the fractional
    parts of multiples of the golden ratio lie as evenly as points can (Weyl's sequence).
    """
    position = ((index + 0.5) * _GOLDEN) % 1.0
    if position < settings.test_share:
        return "test"
    return "validation" if position < settings.test_share + settings.validation_share else "train"


def group_by_shared_keys(keys: Mapping[str, Iterable[str]]) -> dict[str, str]:
    """Groups of names that share a key, directly or by way of others.

    Args:
        keys: Name -> what it must not share with a name of another split, such as its place
            and the digest of its content.

    Returns:
        Name -> its group, which is called like the first of its names.
    """
    leader = {name: name for name in keys}

    def find(name: str) -> str:
        while leader[name] != name:
            leader[name] = leader[leader[name]]
            name = leader[name]
        return name

    first_with: dict[str, str] = {}
    for name in sorted(keys):
        for key in keys[name]:
            one, other = sorted((find(name), find(first_with.setdefault(key, name))))
            leader[other] = one
    return {name: find(name) for name in keys}


def assign_splits(groups: Sequence[str], settings: DatasetSettings, what: str) -> dict[str, str]:
    """The split of each group.

    Args:
        groups: Their names, in any order; the same name may come more than once.
        settings: Shares and seed.
        what: What the groups are, for the message.

    Raises:
        UsageError: If there are fewer groups than splits.
    """
    shares = {"test": settings.test_share, "validation": settings.validation_share}
    wanted = ["train", *(name for name, share in shares.items() if share > 0)]
    ordered = sorted(set(groups), key=lambda group: _position(group, settings.seed))
    if len(ordered) < len(wanted):
        raise UsageError(
            f"{len(ordered)} {what} cannot be split into {', '.join(wanted)}: no {what} may be in "
            "two. Add more, or set --validation-share and --test-share to 0."
        )
    found = {group: _split_at(_position(group, settings.seed), shares) for group in ordered}
    for missing in [name for name in wanted if name not in found.values()]:
        # Of the largest split the group that lies next, so that all else stays as it is.
        largest = max(SPLITS, key=lambda name: sum(split == name for split in found.values()))
        chosen = next(group for group in ordered if found[group] == largest)
        found[chosen] = missing
    return found


def _split_at(position: float, shares: Mapping[str, float]) -> str:
    edge = 0.0
    for name, share in shares.items():
        edge += share
        if position < edge:
            return name
    return "train"


def _position(group: str, seed: int) -> float:
    """Where a group lies in [0, 1), the same for the same name and seed."""
    digest = hashlib.sha256(f"{seed}/{group}".encode()).digest()
    return int.from_bytes(digest[:8], "big") / 2**64
