"""Places boxes in columns so that most arrows point right and few cross, by Sugiyama's method in short.

K. Sugiyama, S. Tagawa, M. Toda: Methods for visual understanding of hierarchical system structures, 1981; the
order that breaks cycles is that of P. Eades, X. Lin, W. F. Smyth, 1993. Sizes are in pixels, y points down.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

Edge = tuple[str, str]

_COLUMN_GAP = 70.0
_ROW_GAP = 14.0
_SWEEPS = 12


@dataclass(frozen=True, slots=True)
class Layout:
    """The centre of each box, the points that each edge passes between its boxes, and the size of it all."""

    centres: Mapping[str, tuple[float, float]]
    bends: Mapping[Edge, tuple[tuple[float, float], ...]]
    width: float
    height: float


def layout(
    sizes: Mapping[str, tuple[float, float]],
    edges: Sequence[Edge],
    columns: Mapping[str, int] | None = None,
) -> Layout:
    """Place boxes of these sizes (width, height). The same input leads to the same picture.

    With `columns`, each box is in the column that is given; no edge may stay within one.
    """
    if columns is None:
        order = _acyclic_order(list(sizes), edges)
        rank: Mapping[str, int] = {box: index for index, box in enumerate(order)}
        forward = {edge: rank[edge[0]] < rank[edge[1]] for edge in edges}
        columns = _columns(order, [(a, b) if forward[a, b] else (b, a) for a, b in edges])
    else:
        forward = {edge: columns[edge[0]] < columns[edge[1]] for edge in edges}
    chains, rows = _with_bends(columns, edges, forward)
    neighbours: defaultdict[str, list[str]] = defaultdict(list)
    for chain in chains.values():
        for left, right in pairwise(chain):
            neighbours[left].append(right)
            neighbours[right].append(left)
    _order_rows(rows, neighbours)
    heights = defaultdict[str, float](lambda: 2.0, {box: size[1] for box, size in sizes.items()})
    y = _heights(rows, neighbours, heights)
    x: dict[str, float] = {}
    edge_of_column = 0.0
    for row in rows:
        width = max((sizes[box][0] for box in row if box in sizes), default=0.0)
        x.update((box, edge_of_column + width / 2) for box in row)
        edge_of_column += width + _COLUMN_GAP
    bends = {
        edge: tuple((x[b], y[b]) for b in (chain if forward[edge] else chain[::-1])[1:-1])
        for edge, chain in chains.items()
    }
    top = min((y[box] - heights[box] / 2 for box in y), default=0.0)
    bottom = max((y[box] + heights[box] / 2 for box in y), default=0.0)
    moved = {edge: tuple((px, py - top) for px, py in points) for edge, points in bends.items()}
    centres = {box: (x[box], y[box] - top) for box in sizes}
    return Layout(centres, moved, edge_of_column - _COLUMN_GAP, bottom - top)


def _acyclic_order(boxes: list[str], edges: Sequence[Edge]) -> list[str]:
    """An order in which few edges point back: sources, then boxes by edges out minus edges in, then sinks."""
    gives: dict[str, set[str]] = {box: set() for box in boxes}
    takes: dict[str, set[str]] = {box: set() for box in boxes}
    for source, target in edges:
        if source != target:
            gives[source].add(target)
            takes[target].add(source)
    first: list[str] = []
    last: list[str] = []
    left = dict.fromkeys(boxes)
    while left:
        first_in = next((box for box in left if not takes[box]), None)
        last_out = next((box for box in left if not gives[box]), None)
        box = first_in or last_out or max(left, key=lambda each: len(gives[each]) - len(takes[each]))
        (last if first_in is None and last_out is not None else first).append(box)
        del left[box]
        for follower in gives[box]:
            takes[follower].discard(box)
        for leader in takes[box]:
            gives[leader].discard(box)
    return [*first, *reversed(last)]


def _columns(order: Sequence[str], edges: Sequence[Edge]) -> dict[str, int]:
    """The column of each box: right of all boxes that it follows, or just left of those that follow it."""
    before: defaultdict[str, list[str]] = defaultdict(list)
    after: defaultdict[str, list[str]] = defaultdict(list)
    for source, target in edges:
        if source != target:
            before[target].append(source)
            after[source].append(target)
    columns: dict[str, int] = {}
    for box in order:
        columns[box] = max((columns[other] + 1 for other in before[box]), default=0)
    for box in order:
        if after[box] and not before[box]:
            columns[box] = min(columns[other] for other in after[box]) - 1
    return columns


def _with_bends(
    columns: Mapping[str, int], edges: Sequence[Edge], forward: Mapping[Edge, bool]
) -> tuple[dict[Edge, list[str]], list[list[str]]]:
    """Each edge as a chain of boxes in neighbouring columns, with a bend wherever it passes through one."""
    rows: list[list[str]] = [[] for _ in range(max(columns.values(), default=0) + 1)]
    for box, column in columns.items():
        rows[column].append(box)
    chains: dict[Edge, list[str]] = {}
    for edge in dict.fromkeys(edges):
        left, right = edge if forward[edge] else edge[::-1]
        chain = [left]
        for column in range(columns[left] + 1, columns[right]):
            bend = f"{edge[0]}\0{edge[1]}\0{column}"
            rows[column].append(bend)
            chain.append(bend)
        chains[edge] = [*chain, right]
    return chains, rows


def _order_rows(rows: list[list[str]], neighbours: Mapping[str, list[str]]) -> None:
    """Sort each column by the mean position of what its boxes are connected to, back and forth."""
    for sweep in range(_SWEEPS):
        side = 1 if sweep % 2 else -1
        for column in range(len(rows))[::-side]:
            if not 0 <= column + side < len(rows):
                continue
            position = {box: index for index, box in enumerate(rows[column + side])}
            here = {box: index for index, box in enumerate(rows[column])}

            def mean(box: str, position: dict[str, int] = position, here: dict[str, int] = here) -> float:
                found = [position[other] for other in neighbours[box] if other in position]
                # Without a neighbour on that side a box stays about where it is.
                return sum(found) / len(found) if found else here[box] * len(position) / len(here)

            rows[column].sort(key=mean)


def _heights(
    rows: Sequence[Sequence[str]],
    neighbours: Mapping[str, list[str]],
    heights: Mapping[str, float],
) -> dict[str, float]:
    """The y of each box: near its neighbours, in its column's order, without overlap."""
    y: dict[str, float] = {}
    for row in rows:
        y.update(zip(row, _spread([0.0] * len(row), [heights[box] for box in row]), strict=True))
    for sweep in range(_SWEEPS):
        for row in rows if sweep % 2 else rows[::-1]:
            wanted = [
                sum(y[other] for other in neighbours[box]) / len(neighbours[box])
                if neighbours[box]
                else y[box]
                for box in row
            ]
            y.update(zip(row, _spread(wanted, [heights[box] for box in row]), strict=True))
    return y


def _spread(wanted: Sequence[float], heights: Sequence[float]) -> list[float]:
    """The places nearest to the wanted ones that keep order and gaps, by pooling adjacent violators."""
    offsets = [0.0]
    for above, below in pairwise(heights):
        offsets.append(offsets[-1] + (above + below) / 2 + _ROW_GAP)
    blocks: list[tuple[float, int]] = []  # the mean of wanted - offset over the given number of boxes
    for place, offset in zip(wanted, offsets, strict=False):
        mean, count = place - offset, 1
        while blocks and blocks[-1][0] > mean:
            other, size = blocks.pop()
            mean, count = (mean * count + other * size) / (count + size), count + size
        blocks.append((mean, count))
    means = [mean for mean, count in blocks for _ in range(count)]
    return [mean + offset for mean, offset in zip(means, offsets, strict=False)]
