"""The algebra of rigid transforms, on tuples of seven floats.

A transform takes coordinates in a child frame to coordinates in its parent: it rotates, then translates. The
rotation is a unit quaternion.
"""

from __future__ import annotations

import math
from typing import TypeAlias

# x, y, z of the translation [m], then x, y, z, w of the rotation.
Transform: TypeAlias = tuple[float, float, float, float, float, float, float]
Vector: TypeAlias = tuple[float, float, float]

IDENTITY: Transform = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def compose(outer: Transform, inner: Transform) -> Transform:
    """Return the transform that does `inner`, then `outer`."""
    x, y, z, ax, ay, az, aw = outer
    ix, iy, iz, bx, by, bz, bw = inner
    # Twice the cross product of the quaternion's vector with the point: 15 products instead of 24.
    tx = 2.0 * (ay * iz - az * iy)
    ty = 2.0 * (az * ix - ax * iz)
    tz = 2.0 * (ax * iy - ay * ix)
    return (
        x + ix + aw * tx + (ay * tz - az * ty),
        y + iy + aw * ty + (az * tx - ax * tz),
        z + iz + aw * tz + (ax * ty - ay * tx),
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by + ay * bw + az * bx - ax * bz,
        aw * bz + az * bw + ax * by - ay * bx,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def rotate(transform: Transform, vector: Vector) -> Vector:
    """Return a vector as the parent frame sees it: rotated, not translated."""
    rotation: Transform = (0.0, 0.0, 0.0, *transform[3:])
    return compose(rotation, (*vector, 0.0, 0.0, 0.0, 1.0))[:3]


def invert(transform: Transform) -> Transform:
    """Return the transform from the parent to the child."""
    x, y, z, qx, qy, qz, qw = transform
    back: Transform = (0.0, 0.0, 0.0, -qx, -qy, -qz, qw)
    return compose(back, (-x, -y, -z, 0.0, 0.0, 0.0, 1.0))


def interpolate(older: Transform, newer: Transform, ratio: float) -> Transform:
    """Return what is between two transforms: at `older` for 0, at `newer` for 1.

    The translation moves in a straight line, the rotation along the shortest arc (slerp).
    """
    x, y, z, ax, ay, az, aw = older
    nx, ny, nz, bx, by, bz, bw = newer
    rest = 1.0 - ratio
    first, second = rest, ratio
    cosine = ax * bx + ay * by + az * bz + aw * bw
    if cosine < 0.0:  # both signs of a quaternion are the same rotation: take the nearer one
        cosine, bx, by, bz, bw = -cosine, -bx, -by, -bz, -bw
    if cosine < 1.0:
        angle = math.acos(cosine)
        sine = math.sin(angle)
        first, second = math.sin(rest * angle) / sine, math.sin(ratio * angle) / sine
    return (
        rest * x + ratio * nx,
        rest * y + ratio * ny,
        rest * z + ratio * nz,
        first * ax + second * bx,
        first * ay + second * by,
        first * az + second * bz,
        first * aw + second * bw,
    )


def normalized(transform: Transform) -> Transform | None:
    """Return a transform whose rotation has length 1; None if it has no length that can be divided by.

    Of the two quaternions for a rotation it is the one that upstream's way over a matrix leads to: w is
    positive, or, for turns of 120 degrees and more, the largest of x, y and z.
    """
    x, y, z, qx, qy, qz, qw = transform
    xx, yy, zz, ww = qx * qx, qy * qy, qz * qz, qw * qw
    square = xx + yy + zz + ww
    if not 0.0 < square < math.inf:
        return None
    if 4.0 * ww > square:
        leading = qw
    elif xx < yy:
        leading = qz if yy < zz else qy
    else:
        leading = qz if xx < zz else qx
    if square == 1.0 and leading > 0.0:
        return transform
    scale = math.copysign(1.0 / math.sqrt(square), leading)
    return (x, y, z, qx * scale, qy * scale, qz * scale, qw * scale)
