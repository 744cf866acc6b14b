"""A set beside its reference, as sections of a report."""

from panokit.qa.sets.changes import Effect
from panokit.qa.sets.comparing import SetComparison
from panokit.qa.sets.multivariate import Separation
from panokit.qa.sets.showing_changes import (
    REFERENCE,
    THESE,
    TONES,
    change_charts,
    change_table,
    percent,
)
from panokit.report.values import (
    Cell,
    Column,
    Count,
    Counts,
    Group,
    Section,
    Table,
    Text,
)
from panokit.report.wording import format_figure, words_of

_MOST_ROWS = 200


def set_sections(found: SetComparison) -> tuple[Section, ...]:
    """What a report tells of a comparison of sets, in one group."""
    sections: list[Section | None] = [
        _head(found),
        Text(paragraphs=(_explanation(found),), small=True),
        change_table(found.changes),
        change_charts(found.changes),
        _distances(found),
        _neighborhood(found),
        _coverage(found),
        _moves(found),
        _duplicates(found),
        _nearest(found),
        _spread(found),
    ]
    shown = tuple(section for section in sections if section is not None)
    return (Group(title="Set against reference", sections=shown),)


def _head(found: SetComparison) -> Counts:
    labels = {
        Effect.DISTORTS: "figures distorted",
        Effect.ADDS: "with added range",
        Effect.SAME: "the same",
        Effect.UNDECIDED: "undecided",
    }
    return Counts(
        counts=tuple(
            Count(
                label=label,
                value=str(found.effects[str(effect)]),
                tone=TONES[effect] if found.effects[str(effect)] else "",
            )
            for effect, label in labels.items()
        )
    )


def _explanation(found: SetComparison) -> str:
    settings = found.settings
    paired = (
        f" {found.paired} of them have their own truth there; where nearly all have, the scenes "
        "are the same, and a wider range is no addition but a distortion."
        if found.paired
        else ""
    )
    drawn = (
        f" The tests are over {found.tested[0]} and {found.tested[1]} of them, drawn by chance."
        if found.tested != (len(found.augmented), len(found.reference))
        else ""
    )
    return (
        f"{len(found.augmented)} maps beside {len(found.reference)} reference maps.{paired}{drawn} "
        f"A figure is distorted if the sets differ (false discovery rate at most "
        f"{settings.false_discovery:g}) and its median is shifted for sure by at least "
        f"{settings.shift_min:g} interquartile ranges (IQR) of the reference, or its spread is "
        f"under {settings.narrower_max:g} of the reference's; it adds range if more than "
        f"{percent(settings.outside_expected)} of the maps lie outside the reference's 5 to 95 % "
        f"range for sure; it is the same if no shift beyond {settings.same_within:g} IQR is "
        "possible. Intervals are 95 % bootstraps over scenes."
    )


def _distances(found: SetComparison) -> Table:
    rows = [
        ("Energy distance", "over all figures at once", found.energy),
        ("Kernel distance", "maximum mean discrepancy, squared", found.kernel),
    ]
    if found.frechet:
        rows.append(("Frechet distance", "of harmonic spectra, degrees 1 to 8", found.frechet))
    return Table(
        title="All figures at once",
        columns=(
            Column(label="Distance"),
            Column(label="Value", numeric=True),
            Column(label="By chance", numeric=True),
            Column(label="95 % of chance below", numeric=True),
            Column(label="p", numeric=True),
        ),
        rows=tuple(_separation_row(*row) for row in rows),
        note="What chance gives is found by exchanging maps between the sets.",
    )


def _separation_row(label: str, note: str, found: Separation) -> tuple[Cell, ...]:
    figures = (found.value, found.expected, found.null, found.p)
    return (
        Cell(text=label, note=note),
        *(Cell(text=format_figure(value), sort=value) for value in figures),
    )


def _neighborhood(found: SetComparison) -> Table | None:
    near = found.neighborhood
    if near is None:
        return None
    meanings = {
        "precision": "maps that look like a reference map",
        "recall": "reference maps that look like one of these maps",
        "density": "how densely these maps lie among the reference; 1 is as densely",
        "coverage": "reference maps that have one of these maps near",
    }
    return Table(
        title="Precision and recall",
        columns=(
            Column(label="Share"),
            Column(label=THESE, numeric=True),
            Column(label="Halves of the reference", numeric=True),
        ),
        rows=tuple(
            (
                Cell(text=words_of(name), note=meaning),
                Cell(text=format_figure(getattr(near, name))),
                Cell(text=format_figure(near.expected[name]) if near.expected else "–"),
            )
            for name, meaning in meanings.items()
        ),
        note=f"Near is within the {near.k} nearest neighbors.",
    )


def _coverage(found: SetComparison) -> Table | None:
    if found.coverage is None:
        return None
    rows = [
        (
            Cell(text=f"{words_of(partition)}: {kind}"),
            Cell(text=str(counts.reference), sort=counts.reference),
            Cell(text=str(counts.covered), sort=counts.covered),
            Cell(text=str(counts.augmented), sort=counts.augmented),
        )
        for partition, kinds in found.coverage.kinds.items()
        for kind, counts in kinds.items()
    ]
    return Table(
        title="Coverage",
        columns=(
            Column(label="Kind"),
            Column(label=REFERENCE, numeric=True),
            Column(label="of them covered", numeric=True),
            Column(label=THESE, numeric=True),
        ),
        rows=tuple(rows[:_MOST_ROWS]),
        note=f"{percent(found.coverage.covered)} of the reference maps have one of these maps "
        "nearer than reference maps of different scenes are to each other in the median.",
        sortable=True,
    )


def _moves(found: SetComparison) -> Table | None:
    changed = {move: count for move, count in found.class_moves.items() if not _stays(move)}
    if not found.class_moves:
        return None
    kept = sum(count for move, count in found.class_moves.items() if _stays(move))
    return Table(
        title="Kinds of light that changed",
        columns=(Column(label="From the truth to the map"), Column(label="Maps", numeric=True)),
        rows=tuple(
            (Cell(text=move.replace(" > ", " to ")), Cell(text=str(count), sort=count))
            for move, count in changed.items()
        ),
        note=f"{kept} of {found.paired} maps have the kind of light of their truth.",
    )


def _stays(move: str) -> bool:
    before, after = move.split(" > ")
    return before == after


def _duplicates(found: SetComparison) -> Section:
    if not found.duplicates:
        return Text(title="Near-duplicates", paragraphs=("None.",))
    return Table(
        title="Near-duplicates",
        columns=(
            Column(label="Map"),
            Column(label="Other map"),
            Column(label="Shared"),
            Column(label="Correlation", numeric=True),
            Column(label="Turned", numeric=True),
            Column(label="Apart", numeric=True),
        ),
        rows=tuple(
            (
                Cell(text=pair.first),
                Cell(text=pair.second),
                Cell(text=f"{pair.likeness}{', mirrored' if pair.mirrored else ''}"),
                Cell(text=format_figure(pair.correlation)),
                Cell(text=format_figure(pair.yaw_deg, "°")),
                Cell(text=format_figure(pair.distance_m, "m")),
            )
            for pair in found.duplicates[:_MOST_ROWS]
        ),
    )


def _nearest(found: SetComparison) -> Group:
    rows = tuple(
        (
            Cell(text=one.member.name, link=one.member.name),
            Cell(text=str(one.description.light_class)),
            Cell(text=near.by_look, note=f"turned by {format_figure(near.yaw_deg, '°')}"),
            Cell(text=format_figure(near.look_stops, "stops"), sort=near.look_stops),
            Cell(text=near.by_spectrum),
            Cell(text=format_figure(near.spectrum_stops, "stops"), sort=near.spectrum_stops),
            Cell(text=str(near.own_rank or "–"), sort=near.own_rank),
        )
        for one in found.augmented
        if (near := one.nearest) is not None
    )
    table = Table(
        columns=(
            Column(label="Map"),
            Column(label="Light"),
            Column(label="Nearest by look"),
            Column(label="Difference", numeric=True),
            Column(label="Nearest by spectrum"),
            Column(label="Difference in power", numeric=True),
            Column(label="Rank of its own truth", numeric=True),
        ),
        rows=rows,
        note="By look: 64x32 pixels of luminance at the best yaw and exposure. By spectrum: power "
        "in the degrees 1 to 8 of harmonics.",
        sortable=True,
    )
    return Group(title="Nearest references", sections=(table,), folded=True)


def _spread(found: SetComparison) -> Table | None:
    ours, theirs = found.augmented_spread, found.reference_spread
    if not ours.located and not theirs.located:
        return None
    rows = [
        ("Maps with a place", ours.located, theirs.located),
        ("Groups within 50 m steps", ours.clusters, theirs.clusters),
        ("Largest group", ours.largest_cluster, theirs.largest_cluster),
        ("Cells of 1 km", ours.cells, theirs.cells),
        ("Named places", len(ours.cities), len(theirs.cities)),
        ("Months of the year", len(ours.months), len(theirs.months)),
        ("Hours of the day", len(ours.solar_hours), len(theirs.solar_hours)),
    ]
    return Table(
        title="Where and when",
        columns=(
            Column(label="Count"),
            Column(label=THESE, numeric=True),
            Column(label=REFERENCE, numeric=True),
        ),
        rows=tuple(
            (Cell(text=label), Cell(text=str(one)), Cell(text=str(other)))
            for label, one, other in rows
        ),
    )
