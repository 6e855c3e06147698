"""Connected regions of a black-and-white image, found row by row: the basis of blob detectors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Region:
    """Pixels that touch by an edge: their number and their box (top, left, bottom, right; end excluded)."""

    label: int
    area: int
    box: tuple[int, int, int, int]


def label_regions(mask: Mask) -> tuple[NDArray[np.intp], list[Region]]:
    """Number the regions of set pixels from 1 on; returns the image of numbers, and the regions."""
    rows, starts, ends = _runs(mask)
    parents = list(range(len(rows)))

    def root(run: int) -> int:
        while parents[run] != run:
            parents[run] = parents[parents[run]]
            run = parents[run]
        return run

    above = 0  # the first run of the row above that may still touch
    for run, row in enumerate(rows):
        while above < run and (
            rows[above] < row - 1 or (rows[above] == row - 1 and ends[above] <= starts[run])
        ):
            above += 1
        other = above
        while other < run and rows[other] == row - 1 and starts[other] < ends[run]:
            one, two = sorted((root(other), root(run)))
            parents[two] = one
            other += 1
    numbers: dict[int, int] = {}
    labels = np.zeros(mask.shape, dtype=np.intp)
    boxes: list[list[int]] = []
    for run, row in enumerate(rows):
        number = numbers.setdefault(root(run), len(numbers))
        start, end = starts[run], ends[run]
        labels[row, start:end] = number + 1
        if number == len(boxes):
            boxes.append([0, row, start, row + 1, end])
        box = boxes[number]
        box[0] += end - start
        box[2], box[3], box[4] = min(box[2], start), row + 1, max(box[4], end)
    return labels, [
        Region(number + 1, area, (top, left, bottom, right))
        for number, (area, top, left, bottom, right) in enumerate(boxes)
    ]


def _runs(mask: Mask) -> tuple[list[int], list[int], list[int]]:
    """Rows, starts and ends of the runs of set pixels, from top left to bottom right."""
    padded = np.zeros((mask.shape[0], mask.shape[1] + 2), dtype=np.int8)
    padded[:, 1:-1] = mask
    change = np.diff(padded, axis=1)
    rows, starts = np.nonzero(change == 1)
    _, ends = np.nonzero(change == -1)
    return rows.tolist(), starts.tolist(), ends.tolist()
