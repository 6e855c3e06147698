"""Finds the face on its board in a camera image, and where it is: thresholds, regions, moments.

A face is a bright region with the outline of an ellipse, dark all around, with three dark holes: two eyes in
the upper half and a mouth in the lower one. The ellipse's size gives the distance, since the face's own size
is known.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..robot.scene import EYE_PLACE, FACE_RADIUS, MOUTH_PLACE
from .regions import Mask, Region, label_regions

LABEL = "face"
_THRESHOLDS = (70, 100, 130, 160, 190)  # of brightness, 0 to 255
_SMALLEST = 9  # minimum width and height of a face in pixels
_OVAL = 0.035  # relative difference allowed between a region's area and its ellipse's; a square's is 0.045
_PLACE = 0.22  # distance that a hole may be from its place, in half axes
_CONTRAST = 40  # difference of brightness between the face and its surroundings
_HOLES = (
    (-EYE_PLACE[0] / FACE_RADIUS, EYE_PLACE[1] / FACE_RADIUS),
    (EYE_PLACE[0] / FACE_RADIUS, EYE_PLACE[1] / FACE_RADIUS),
    (0.0, MOUTH_PLACE / FACE_RADIUS),
)


@dataclass(frozen=True, slots=True)
class Detection:
    """A face: its region (left, top, width, height) in pixels, and its centre in the optical frame [m].

    The optical frame has x to the right, y down and z out of the camera. The orientation is not estimated.
    """

    confidence: float  # 0 to 1: share of the thresholds at which it is found
    region: tuple[int, int, int, int]
    position: tuple[float, float, float]
    label: str = LABEL
    size: float = 2 * FACE_RADIUS


@dataclass(frozen=True, slots=True)
class _Ellipse:
    """Centre in pixels, and the half axes as directions (rows of 2) with their lengths."""

    x: float
    y: float
    half: tuple[float, float]  # wide, high
    major: float


def detect(picture: NDArray[np.uint8], fovy: float) -> list[Detection]:
    """Find faces in an image (height, width, 3) of a camera with a vertical field of view [degrees].

    The most confident come first.
    """
    bright = picture.astype(np.float32) @ np.array([0.299, 0.587, 0.114], dtype=np.float32)
    found: list[tuple[_Ellipse, Region]] = []
    for threshold in _THRESHOLDS:
        found.extend(_faces(bright, bright > threshold))
    groups: list[list[tuple[_Ellipse, Region]]] = []
    for ellipse, region in found:
        for group in groups:
            if math.hypot(ellipse.x - group[0][0].x, ellipse.y - group[0][0].y) < 0.5 * group[0][0].major:
                group.append((ellipse, region))
                break
        else:
            groups.append([(ellipse, region)])
    detections = [_detection(group, picture.shape, fovy) for group in groups]
    return sorted(detections, key=lambda detection: -detection.confidence)


def _faces(bright: NDArray[np.float32], mask: Mask) -> list[tuple[_Ellipse, Region]]:
    """The faces found at one threshold."""
    height, width = mask.shape
    labels, regions = label_regions(mask)
    faces = []
    for region in regions:
        top, left, bottom, right = region.box
        if top == 0 or left == 0 or bottom == height or right == width:
            continue
        if min(bottom - top, right - left) < _SMALLEST or not 0.3 < (right - left) / (bottom - top) < 2:
            continue
        inside = labels[top:bottom, left:right] == region.label
        holes = _holes(inside)
        filled = inside | np.isin(holes[0], [hole.label for hole in holes[1]])
        ellipse = _ellipse(filled, top, left)
        if ellipse is None or not _has_face(ellipse, holes, top, left):
            continue
        if _surrounded_by_dark(bright, ellipse):
            faces.append((ellipse, region))
    return faces


def _holes(inside: Mask) -> tuple[NDArray[np.intp], list[Region]]:
    """The dark regions within a region: those that do not touch the edge of its box."""
    labels, regions = label_regions(~inside)
    height, width = inside.shape
    return labels, [
        hole
        for hole in regions
        if hole.box[0] > 0 and hole.box[1] > 0 and hole.box[2] < height and hole.box[3] < width
    ]


def _ellipse(filled: Mask, top: int, left: int) -> _Ellipse | None:
    """The ellipse of equal second moments, if the region has its shape."""
    rows, columns = np.nonzero(filled)
    covariance = np.cov(np.vstack([columns, rows])) + np.eye(2) / 12  # a pixel is a square, not a point
    minor, major = (2 * math.sqrt(value) for value in np.linalg.eigvalsh(covariance))
    if abs(len(rows) / (math.pi * minor * major) - 1) > _OVAL:
        return None
    half = (2 * math.sqrt(covariance[0, 0]), 2 * math.sqrt(covariance[1, 1]))
    return _Ellipse(float(columns.mean()) + left, float(rows.mean()) + top, half, major)


def _has_face(ellipse: _Ellipse, holes: tuple[NDArray[np.intp], list[Region]], top: int, left: int) -> bool:
    """Whether the three largest holes are where eyes and mouth belong and no other hole is half as large."""
    labels, regions = holes
    largest = sorted(regions, key=lambda hole: -hole.area)
    if len(largest) < 3 or (len(largest) > 3 and largest[3].area > 0.5 * largest[2].area):
        return False
    places = []
    for hole in largest[:3]:
        rows, columns = np.nonzero(labels == hole.label)
        x = (float(columns.mean()) + left - ellipse.x) / ellipse.half[0]
        y = (ellipse.y - float(rows.mean()) - top) / ellipse.half[1]
        places.append((x, y))
    return all(min(math.hypot(x - u, y - v) for x, y in places) < _PLACE for u, v in _HOLES)


def _surrounded_by_dark(bright: NDArray[np.float32], ellipse: _Ellipse) -> bool:
    """Whether the ring just outside the ellipse is darker than the one just inside."""
    angles = np.linspace(0, 2 * math.pi, 32, endpoint=False)

    def ring(scale: float) -> float:
        x = ellipse.x + scale * ellipse.half[0] * np.cos(angles)
        y = ellipse.y + scale * ellipse.half[1] * np.sin(angles)
        columns = np.clip(np.rint(x).astype(int), 0, bright.shape[1] - 1)
        rows = np.clip(np.rint(y).astype(int), 0, bright.shape[0] - 1)
        return float(np.median(bright[rows, columns]))

    return ring(0.8) - ring(1.2) > _CONTRAST


def _detection(group: list[tuple[_Ellipse, Region]], shape: tuple[int, ...], fovy: float) -> Detection:
    """One face, from all thresholds at which it is found: the middle one."""
    ellipse, region = sorted(group, key=lambda face: face[0].major)[len(group) // 2]
    height, width = shape[:2]
    focal = height / 2 / math.tan(math.radians(fovy) / 2)
    z = focal * FACE_RADIUS / ellipse.major  # a disc seen at an angle gets narrower; its longer axis stays
    x, y = (ellipse.x + 0.5 - width / 2) / focal * z, (ellipse.y + 0.5 - height / 2) / focal * z
    top, left, bottom, right = region.box
    return Detection(len(group) / len(_THRESHOLDS), (left, top, right - left, bottom - top), (x, y, z))
