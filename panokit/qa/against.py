"""All maps against folders of others: each against its truth, and the set against a set."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

from panokit.console import Tick
from panokit.errors import UsageError
from panokit.qa.items import QaItem, find_maps
from panokit.qa.pairs.judging import Matches, PairResults, judge_pairs, match_truths
from panokit.qa.sets.comparing import LEAST_MAPS, SetComparison, compare_sets
from panokit.qa.sets.members import Member, members_of
from panokit.qa.sets.settings import SetSettings
from panokit.qa.sets.store import STORE_NAME, DescriptionStore
from panokit.qa.settings import QaSettings

Stage = Callable[[str, int], AbstractContextManager[Tick]]


def no_stage(name: str, total: int) -> AbstractContextManager[Tick]:
    """Progress that nobody watches; see `panokit.console.Console.stage`."""
    return nullcontext(lambda *, rejected=False: None)


def matches_of(maps: Sequence[QaItem], reference: Path | None, truth: Path | None) -> Matches:
    """Which truth belongs to which map.

    Args:
        maps: The maps; one with a `truth_path` has it already.
        reference: A folder of maps; those with the name of a map are its truth if `truth` is
            not given, and others are none.
        truth: A folder of true maps.

    Raises:
        UsageError: If a folder does not exist or holds no maps.
    """
    if truth is not None:
        return match_truths(maps, truth)
    if reference is not None:
        found = match_truths(maps, reference)
        # Most references are no truth of anything, so nothing is amiss with them.
        return Matches(truths=found.truths)
    return Matches(truths={item.name: item.truth_path for item in maps if item.truth_path})


def pairs_of(
    maps: Sequence[QaItem],
    matches: Matches,
    settings: QaSettings,
    out: Path | None,
    stage: Stage = no_stage,
) -> PairResults | None:
    """Every map with a truth against it; None where there is no truth and none was asked for."""
    if not matches.truths and not matches.unused:
        return None
    with stage("pairs", len(matches.truths)) as tick:
        return judge_pairs(
            maps, matches, settings, out=out, on_judged=lambda s: tick(rejected=bool(s.obstacle))
        )


def set_against(
    maps: Sequence[QaItem],
    reference: Path,
    least_references: int,
    out: Path | None,
    stage: Stage = no_stage,
    *,
    settings: SetSettings | None = None,
) -> SetComparison | None:
    """The readable maps as a set beside the reference; None where there are too few of either.

    Args:
        maps: Those that can be read.
        reference: The folder of the reference set.
        least_references: With fewer there is no set.
        out: The report's folder, where descriptions of maps are kept; None to keep none.
        stage: Shows progress.
        settings: The rule's numbers.
    """
    references = members_of(reference)
    if len(maps) < LEAST_MAPS or len(references) < least_references:
        return None
    names = {member.name for member in references} | set(find_maps(reference))
    ours = [_member(item, names) for item in maps]
    store = DescriptionStore(out / STORE_NAME if out else None)
    with stage("sets", len(ours) + len(references)) as tick:
        try:
            return compare_sets(
                ours, references, settings, store=store, on_described=lambda _: tick()
            )
        except UsageError:
            # References that are broken are counted only when all have been read.
            return None


def _member(item: QaItem, names: set[str]) -> Member:
    """A map under the name that its own truth has in the reference, if it is there."""
    known = (item.name, *((item.capture.id, item.capture.key) if item.capture else ()))
    name = next((name for name in known if name in names), item.name)
    return Member(name=name, path=item.map_path, capture=item.capture)
