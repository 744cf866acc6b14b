"""Which pixel of a hole takes which shift, so that the seams between the copies show least.

A seam between two copies costs as much as they differ on both of its sides (Kwatra et al.
2003, "Graphcut Textures"), and a little for its length. One shift after the other may take
over any pixels it likes; which, is a minimal cut of a graph (Boykov et al. 2001, "Fast
Approximate Energy Minimization via Graph Cuts"). The costs are distances, so every such step
is solved exactly.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import breadth_first_order, maximum_flow

# Costs are whole numbers in the graph: this many to a gray level.
_PER_LEVEL = 8
_NEVER = 1 << 24
_SWEEPS = 2


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Copies:
    """What every shift would put into every pixel of the hole.

    Attributes:
        number: (H, W) int, the pixel's place in the list of the hole's pixels; -1 elsewhere.
        values: (labels, pixels, C) float32.
        costs: (labels, pixels) float32, of taking the shift there, in gray levels; infinite
            where it would copy from what must not be copied.
        seam: What each pixel of a seam costs for its length, in gray levels.
        noise: Differences below it hardly show; they count with their square.
    """

    number: NDArray[np.intp]
    values: NDArray[np.float32]
    costs: NDArray[np.float32]
    seam: float
    noise: float


def best_labels(copies: Copies) -> NDArray[np.intp]:
    """The shift that each pixel of the hole takes, (pixels,); -1 where none can serve it."""
    pairs = _neighbors(copies.number)
    served = np.isfinite(copies.costs).any(axis=0)
    labels = np.where(served, np.argmin(_smoothed(copies), axis=0), -1)
    labels = _valid(labels, copies)
    used = list(range(len(copies.costs)))
    for sweep in range(_SWEEPS):
        before = labels.copy()
        for label in used:
            labels = _expanded(labels, label, copies, pairs)
        if np.array_equal(before, labels):
            break
        if sweep == 0:
            # What nobody took in the first sweep hardly is taken later.
            used = [int(label) for label in np.unique(labels) if label >= 0]
    return labels


def _smoothed(copies: Copies) -> NDArray[np.float64]:
    """A start: the shift that can serve most comes first, the rest by what they cost."""
    reach = np.isfinite(copies.costs).mean(axis=1)
    first = np.where(np.isfinite(copies.costs), copies.costs, _NEVER).astype(np.float64)
    return first + 100 * (1 - reach)[:, None]


def _valid(labels: NDArray[np.intp], copies: Copies) -> NDArray[np.intp]:
    ok = labels >= 0
    at = np.flatnonzero(ok)
    bad = at[~np.isfinite(copies.costs[labels[at], at])]
    labels = labels.copy()
    labels[bad] = -1
    return labels


def _neighbors(number: NDArray[np.intp]) -> NDArray[np.intp]:
    """Pairs of neighboring pixels that are both in the hole, (pairs, 2)."""
    beside = np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], axis=1)
    below = np.stack([number[:-1].ravel(), number[1:].ravel()], axis=1)
    both = np.concatenate([beside, below])
    return both[(both >= 0).all(axis=1)]


def _expanded(
    labels: NDArray[np.intp], label: int, copies: Copies, pairs: NDArray[np.intp]
) -> NDArray[np.intp]:
    """The labels after one shift took over what it may improve."""
    free = np.isfinite(copies.costs[label]) & (labels >= 0) & (labels != label)
    if not free.any():
        return labels
    count = len(labels)
    node = np.full(count, -1)
    node[free] = np.arange(free.sum())
    at = np.flatnonzero(free)
    keep = copies.costs[labels[at], at].astype(np.float64)
    take = copies.costs[label, at].astype(np.float64)
    touched = free[pairs[:, 0]] | free[pairs[:, 1]]
    a, b = pairs[touched].T
    a, b = a[(labels[a] >= 0) & (labels[b] >= 0)], b[(labels[a] >= 0) & (labels[b] >= 0)]
    as_is = _seam(labels[a], labels[b], a, b, copies)
    a_takes = _seam(np.full(len(a), label), labels[b], a, b, copies)
    b_takes = _seam(labels[a], np.full(len(a), label), a, b, copies)
    a_free, b_free = free[a], free[b]
    one = a_free & ~b_free
    np.add.at(keep, node[a[one]], as_is[one])
    np.add.at(take, node[a[one]], a_takes[one])
    other = b_free & ~a_free
    np.add.at(keep, node[b[other]], as_is[other])
    np.add.at(take, node[b[other]], b_takes[other])
    both = a_free & b_free
    i, j = node[a[both]], node[b[both]]
    # E(keep, keep) = A, E(keep, take) = B, E(take, keep) = C, E(take, take) = 0, with
    # A <= B + C: as costs of one pixel each, and of a cut between the two.
    kept_both, j_takes, i_takes = as_is[both], b_takes[both], a_takes[both]
    np.add.at(keep, j, kept_both - j_takes)
    np.add.at(keep, i, j_takes)
    link = np.maximum(i_takes + j_takes - kept_both, 0)
    takes = _cut(keep, take, i, j, link)
    result = labels.copy()
    result[at[takes]] = label
    return result


def _seam(
    first: NDArray[np.intp],
    second: NDArray[np.intp],
    a: NDArray[np.intp],
    b: NDArray[np.intp],
    copies: Copies,
) -> NDArray[np.float64]:
    """What it costs that pixel a has one label and its neighbor b another."""
    values = copies.values
    at_a = visible(values[first, a] - values[second, a], copies.noise)
    at_b = visible(values[first, b] - values[second, b], copies.noise)
    return np.where(first == second, 0.0, at_a + at_b + copies.seam).astype(np.float64)


def visible(difference: NDArray[np.float32], noise: float) -> NDArray[np.float32]:
    """How much a difference (..., C) shows: its length, less where it drowns in the noise."""
    length = np.sqrt(np.einsum("...c,...c->...", difference, difference))
    return np.asarray(length * length / (length + np.float32(noise)), np.float32)


def _cut(
    keep: NDArray[np.float64],
    take: NDArray[np.float64],
    i: NDArray[np.intp],
    j: NDArray[np.intp],
    link: NDArray[np.float64],
) -> NDArray[np.bool_]:
    """Which nodes take: the cheapest choice, given what i taking without j (not j alone) costs."""
    count = len(keep)
    source, sink = count, count + 1
    extra = keep - take
    nodes = np.arange(count)
    # A node on the source's side takes; keeping it cuts its edge from the source.
    gains, losses = extra > 0, extra < 0
    tail = np.concatenate([np.full(gains.sum(), source), nodes[losses], i])
    head = np.concatenate([nodes[gains], np.full(losses.sum(), sink), j])
    cost = np.concatenate([extra[gains], -extra[losses], link]) * _PER_LEVEL
    cost = np.minimum(np.rint(cost), _NEVER).astype(np.int32)
    graph = csr_matrix((cost, (tail, head)), shape=(count + 2, count + 2))
    graph.sum_duplicates()
    if not gains.any():
        return np.zeros(count, np.bool_)
    flow = maximum_flow(graph, source, sink, method="dinic").flow
    rest = csr_matrix(graph - flow)
    rest.data[rest.data < 0] = 0
    rest.eliminate_zeros()
    reached = breadth_first_order(rest, source, return_predecessors=False)
    takes = np.zeros(count + 2, np.bool_)
    takes[reached] = True
    return takes[:count]
