"""From footsteps to a reference motion: where the ZMP should be, and the DCM that follows from it.

The ZMP is the zero-moment point, which lies under the soles. The DCM is the divergent component of motion,
c + c'/w for the centre of mass c and the natural frequency w. Between steps the ZMP moves from one sole to
the other while both carry. The DCM is computed backwards from the end, where it rests on the ZMP:
X_k = a X_(k+1) + (1 - a) Z_k with a = exp(-w dt). This DCM neither falls behind nor runs away.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..data import STEP_TIME, Footstep, Leg
from ..robot.table import STANCE_WIDTH
from ..spatial import Array, from_frame
from .pace import Pace

PREVIEW = 4  # steps that the reference looks ahead: later ones weigh exp(-w t) < 1e-5


@dataclass(frozen=True, slots=True)
class GaitParameters:
    """Parameters of a walk. Times in seconds, lengths in metres; gains have no unit unless one is named.

    The first three follow from the speed: see `at_pace`. Lengths are those of our robot; `fitting.fitted`
    makes them those of another.
    """

    com_height: float = Pace().com_height
    double_support: float = Pace().double_support
    reach: float = Pace().reach  # between the soles, of a step that can be taken
    stance_width: float = STANCE_WIDTH
    first_double_support: float = 1.2  # from standing
    settle: float = 0.5  # from the last step until the robot counts as standing
    lift: float = 0.05
    zmp_ahead: float = 0.02  # of the sole frame
    zmp_inwards: float = 0.012  # of the sole frame while it carries alone: no step can catch an outward fall
    dcm_gain: float = 1.5
    integral_gain: float = 3.0  # 1/s
    tilt_gain: float = 0.3
    edge_along: float = 0.010  # of a sole; the ZMP does not use it
    edge_across: float = 0.006

    def at_pace(self, pace: Pace) -> GaitParameters:
        """The same parameters for a walk at another speed."""
        return replace(self, com_height=pace.com_height, double_support=pace.double_support, reach=pace.reach)


@dataclass(frozen=True, slots=True)
class Segment:
    """A stretch of time in which the ZMP moves from one point to another.

    While a leg swings, `step` is the step that it takes, and `phase` the share of the swing that is completed
    when the segment begins.
    """

    duration: float
    start: Array  # (2,)
    end: Array
    step: Footstep | None = None
    phase: float = 0.0


@dataclass(frozen=True, slots=True)
class Sample:
    """The reference at one control tick."""

    zmp: Array  # (2,)
    dcm: Array  # (2,) at the end of the tick
    swing: Footstep | None  # the step under way
    phase: float  # completed share of the swing
    last_of_swing: bool
    time_left: float  # until touchdown, seconds; 0 while both feet carry
    over: bool  # nothing moves any longer


class Reference:
    """ZMP and DCM over the control ticks to come."""

    def __init__(self, segments: Sequence[Segment], omega: float, period: float) -> None:
        self._period = period
        self._segments = segments
        self._zmp: list[Array] = []
        self._at: list[tuple[int, int, int]] = []  # segment, tick in it, its ticks
        for number, segment in enumerate(segments):
            ticks = max(1, round(segment.duration / period))
            u = (np.arange(ticks) + 0.5) / ticks
            smooth = u * u * (3 - 2 * u)
            self._zmp.extend(segment.start + smooth[:, None] * (segment.end - segment.start))
            self._at.extend((number, tick, ticks) for tick in range(ticks))
        self._dcm = _backwards(self._zmp, math.exp(-omega * period))
        self._tick = 0

    @property
    def over(self) -> bool:
        """Whether the reference has reached its end, where it stands still."""
        return self._tick >= len(self._zmp)

    def next(self) -> Sample:
        """Return the reference of the present tick; the next call returns that of the next tick."""
        if self.over:
            return Sample(self._zmp[-1], self._dcm[-1], None, 0.0, False, 0.0, True)
        number, tick, ticks = self._at[self._tick]
        segment = self._segments[number]
        phase = segment.phase + (1 - segment.phase) * tick / ticks if segment.step else 0.0
        left = (ticks - tick) * self._period if segment.step else 0.0
        sample = Sample(
            self._zmp[self._tick],
            self._dcm[self._tick],
            segment.step,
            phase,
            segment.step is not None and tick == ticks - 1,
            left,
            False,
        )
        self._tick += 1
        return sample


def _backwards(zmp: list[Array], a: float) -> list[Array]:
    """The DCM for each ZMP, from the last one back."""
    x, y = zmp[-1]
    b = 1 - a
    points: list[tuple[float, float]] = []
    for zx, zy in reversed(np.array(zmp).tolist()):
        x, y = a * x + b * zx, a * y + b * zy
        points.append((x, y))
    return list(np.array(points[::-1]))


def support_point(foot: Array, leg: Leg, parameters: GaitParameters) -> Array:
    """The point (2,) where the ZMP rests while the sole of a leg, at a planar pose, carries alone."""
    return from_frame(foot, np.array([parameters.zmp_ahead, -leg.sign * parameters.zmp_inwards]))


def walking_reference(
    parameters: GaitParameters,
    feet: Sequence[Array],
    steps: Sequence[Footstep],
    zmp: Array,
    first: float,
) -> list[Segment]:
    """The segments of a walk that begins with both feet on the ground.

    `feet` are planar poses of the soles, `zmp` (2,) is where the ZMP is now, and `first` is how long both
    feet continue to carry [s]. Without steps the ZMP comes to rest between the feet.
    """
    segments: list[Segment] = []
    feet, double = list(feet), first
    for step in steps[:PREVIEW]:
        target = support_point(feet[step.leg.other.side], step.leg.other, parameters)
        segments.append(Segment(double, zmp, target))
        segments.append(Segment(step.step_time, target, target, step))
        feet[step.leg.side] = step.pose
        zmp, double = target, parameters.double_support
    return [*segments, *_rest(parameters, feet, zmp, 2 * double if steps else first)]


def swinging_reference(
    parameters: GaitParameters,
    feet: Sequence[Array],
    steps: Sequence[Footstep],
    swing: tuple[float, float],
) -> list[Segment]:
    """The segments of a walk that begins in the middle of a swing, that of steps[0].

    `swing` is the completed share of that swing and the time left [s].
    """
    phase, left = swing
    step = steps[0]
    point = support_point(feet[step.leg.other.side], step.leg.other, parameters)
    landed = list(feet)
    landed[step.leg.side] = step.pose
    later = walking_reference(parameters, landed, steps[1:], point, parameters.double_support)
    if len(steps) == 1:
        later = _rest(parameters, landed, point, 2 * parameters.double_support)
    return [Segment(left, point, point, step, phase), *later]


def _rest(parameters: GaitParameters, feet: Sequence[Array], zmp: Array, duration: float) -> list[Segment]:
    """The end: the ZMP moves between the feet and stays there."""
    end = middle(feet, parameters)
    return [Segment(duration, zmp, end), Segment(parameters.settle, end, end)]


def middle(feet: Sequence[Array], parameters: GaitParameters) -> Array:
    """The point (2,) where the ZMP rests while both feet carry equally."""
    left, right = (support_point(foot, leg, parameters) for foot, leg in zip(feet, Leg, strict=True))
    return (left + right) / 2


def straight_steps(
    count: int, length: float, width: float, step_time: float = STEP_TIME
) -> tuple[Footstep, ...]:
    """Steps straight ahead from feet side by side at x = 0; the last step brings them side by side again."""
    legs = (Leg.RIGHT, Leg.LEFT)
    return tuple(
        Footstep(i, legs[i % 2], length * min(i + 1, count - 1), legs[i % 2].sign * width / 2, 0.0, step_time)
        for i in range(count)
    )
