"""Balance: from the error of the motion to the wanted ZMP, and from that to forces under the soles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..data import Leg
from ..robot.model import SoleGeometry
from ..spatial import Array, from_frame, to_frame
from .reference import GaitParameters, support_point

_INTEGRAL_LIMIT = 0.02  # m s
# A push is not a lasting error. Larger errors [m] are not summed up: they would push back long after the
# robot has caught itself. Meanwhile the sum fades within a second.
_LASTING = 0.02


@dataclass(frozen=True, slots=True)
class Load:
    """The soles' (left, right) shares of the weight, and the points where the ground's force acts on them."""

    zmp: Array  # (2,) of both together
    points: tuple[Array, Array]  # (2,) each
    shares: tuple[float, float]  # sum 1


class DcmFeedback:
    """Moves the ZMP so that the DCM returns to its reference."""

    def __init__(self, parameters: GaitParameters, period: float) -> None:
        self._parameters = parameters
        self._period = period
        self._integral = np.zeros(2)

    def reset(self) -> None:
        """Forget the sum of the errors."""
        self._integral[:] = 0.0

    def zmp(self, reference: Array, error: Array) -> Array:
        """The wanted ZMP (2,), for the reference ZMP and a DCM that is off by `error` (2,)."""
        lasting = np.where(np.abs(error) < _LASTING, error, -self._integral)
        self._integral = np.clip(self._integral + lasting * self._period, -_INTEGRAL_LIMIT, _INTEGRAL_LIMIT)
        return (
            reference
            + (1 + self._parameters.dcm_gain) * error
            + self._parameters.integral_gain * self._integral
        )


def usable(sole: SoleGeometry, parameters: GaitParameters) -> SoleGeometry:
    """The part of a sole that the ZMP may use."""
    along, across = sole.half_length - parameters.edge_along, sole.half_width - parameters.edge_across
    return SoleGeometry(sole.centre, along, across)


def limits(sole: SoleGeometry, parameters: GaitParameters) -> tuple[Array, Array]:
    """The corners (2,) of the part of a sole that the ZMP may use, in the sole's frame."""
    part = usable(sole, parameters)
    along, across = part.half_length, part.half_width
    return np.array([part.centre - along, -across]), np.array([part.centre + along, across])


def distribute(
    wanted: Array, soles: Sequence[Array], stance: int | None, sole: SoleGeometry, parameters: GaitParameters
) -> Load:
    """The load of each sole (planar pose) for a wanted ZMP (2,), within the soles.

    `stance` is the side that carries alone, or None. With both on the ground, the ZMP's place on the line
    between them decides the shares. Both soles take on the remaining offset equally.
    """
    low, high = limits(sole, parameters)

    def within(point: Array, side: int) -> Array:
        return from_frame(soles[side], np.clip(to_frame(soles[side], point), low, high))

    if stance is not None:
        point = within(wanted, stance)
        return Load(point, (point, point), (1.0, 0.0) if stance == 0 else (0.0, 1.0))
    left, right = (support_point(foot, leg, parameters) for foot, leg in zip(soles, Leg, strict=True))
    line = left - right
    share = float(np.clip((wanted - right) @ line / (line @ line), 0.0, 1.0))
    rest = wanted - (share * left + (1 - share) * right)
    points = within(left + rest, 0), within(right + rest, 1)
    return Load(share * points[0] + (1 - share) * points[1], points, (share, 1 - share))
