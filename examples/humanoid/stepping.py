"""Which foot is where and which moves next: footsteps, their reference, and changes on the way."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from . import swing
from .balance import limits
from .data import Footstep, FootstepPlan, Leg, Stance, Support
from .model import SoleGeometry
from .reference import GaitParameters, Reference, Sample, middle, swinging_reference, walking_reference
from .spatial import Array, to_frame, wrap

_ADJUSTABLE = 0.9  # share of a swing until which its landing may still move
_MOVED = 0.01  # metres by which a landing must have moved to take the steps after it along
_LONGEST, _NARROWEST = 0.60, 0.11  # of a step: between the soles, and sideways; metres
# Errors of the DCM [m] from which on a swing is hurried: outwards, inwards, along; and what time [s] is soon.
_FALLING_OUT, _FALLING_IN, _FALLING_ALONG, _SOON = 0.035, 0.06, 0.10, 0.25
_LANDING_TIME = 0.3  # seconds until a swing that is broken off touches ground


class Stepping:
    """Follows footsteps in time. Everything is in the world; `period` is that of control [s]."""

    def __init__(self, parameters: GaitParameters, omega: float, period: float, sole: SoleGeometry) -> None:
        self._parameters, self._omega, self._period = parameters, omega, period
        self._low, self._high = limits(sole, parameters)
        self.plan_id = 0
        self.index = 0  # of the step under way or to come
        self.taken = 0
        self._double_left = 0.0  # seconds until the next foot may leave the ground
        self._hurried = False  # the swing under way
        self.adjusted = 0  # landings that were moved to keep the balance
        self.stand([np.array([0.0, side, 0.0]) for side in (0.09, -0.09)])

    def stand(self, feet: Sequence[Array]) -> None:
        """Begin anew, standing on both feet (planar poses)."""
        self.feet = [foot.copy() for foot in feet]
        self.steps: list[Footstep] = []
        self.zmp = middle(feet, self._parameters)
        self.com: Array = self.zmp.copy()  # reference of the centre of mass, (2,)
        self.sample = self._rebuild(0.2)

    @property
    def standing(self) -> bool:
        """Whether no step is under way or to come, and the weight is between the feet."""
        return not self.steps and self._reference.over

    @property
    def stance(self) -> Stance:
        """The reference's feet and which of them carry."""
        moving = self.sample.swing
        support = Support.BOTH if moving is None else (Support.RIGHT, Support.LEFT)[moving.leg.side]
        return Stance(support, (self.feet[0].copy(), self.feet[1].copy()))

    def follow(self, plan: FootstepPlan) -> str:
        """Take the steps of a plan from now on; says why it cannot, or nothing.

        The step under way is finished first: of a plan that was made while it was still to come, steps up to
        its index count as taken.
        """
        steps = list(plan.steps)
        moving = self.sample.swing
        if self.steps:
            current = self.steps[0]
            later = [step for step in steps if step.index > current.index]
            same = [step for step in steps if step.index == current.index and step.leg is current.leg]
            steps = [*(same if same and moving is None else [current]), *later]
            if not plan.steps and moving is None:
                steps = []
        if problem := self._problem(steps):
            return problem
        before = self.steps
        self.plan_id = plan.plan_id
        self.steps = steps
        if moving is not None:
            self._continue_swing(self.sample.phase, self.sample.time_left - self._period)
        elif steps and not before:
            self._rebuild(self._parameters.first_double_support)
        elif steps:
            self._rebuild(self._double_left)  # the weight goes on to the same foot
        elif before:
            self._rebuild(2 * self._parameters.double_support)
        self.index = steps[0].index if steps else self.index
        return ""

    def next(self) -> Sample:
        """The reference of the next control tick; moves the reference of the centre of mass along."""
        sample = self._reference.next()
        if sample.swing is not None and (self.sample.swing is not sample.swing):
            self._lift_off(sample.swing)
        self._double_left = max(0.0, self._double_left - self._period)
        self.velocity = self._omega * (sample.dcm - self.com)
        self.com = self.com + self.velocity * self._period
        self.zmp = sample.zmp
        self.sample = sample
        return sample

    def adjust(self, error: Array) -> None:
        """Move the landing of the swing under way so that it catches an error of the DCM (2,)."""
        moving, sample = self.sample.swing, self.sample
        if moving is None or sample.phase >= _ADJUSTABLE:
            return
        stance = self.feet[moving.leg.other.side]
        self._hurry(moving.leg, to_frame(np.array([0.0, 0.0, stance[2]]), error))
        local = to_frame(stance, sample.zmp)
        target = swing.adjusted_landing(
            self._planned[:2],
            stance,
            moving.leg.sign,
            error,
            (self._low - local, self._high - local),
            math.exp(self._omega * sample.time_left),
        )
        self.landing[:2] = swing.moved(self.landing[:2], target, self._period)

    def _hurry(self, leg: Leg, error: Array) -> None:
        """Land sooner where the robot falls faster than the landing can follow; once a swing.

        Most of all to the outside of the stance foot, where no step can catch it. `error` (2,) is the DCM's,
        seen from that foot.
        """
        left, inwards = self.sample.time_left, leg.sign * error[1]
        falling = inwards < -_FALLING_OUT or inwards > _FALLING_IN or abs(error[0]) > _FALLING_ALONG
        if falling and left > _SOON and not self._hurried:
            self._hurried = True
            self._continue_swing(self.sample.phase, max(0.8 * _SOON, 0.6 * left))

    def targets(self) -> list[tuple[Array, float]]:
        """Planar pose and height of both soles at this tick."""
        poses = [(foot, 0.0) for foot in self.feet]
        if self.sample.swing is not None:
            side = self.sample.swing.leg.side
            poses[side] = swing.foot_pose(
                self.feet[side], self.landing, self.sample.phase, self._parameters.lift
            )
        return poses

    def touchdown(self, measured: Sequence[Array]) -> None:
        """The swing is over: go on from where the soles (planar poses) really are."""
        done = self.steps.pop(0)
        shift = self.landing[:2] - self._planned[:2]
        if math.hypot(*shift) > _MOVED:
            self.adjusted += 1
            self.steps = [replace(s, x=s.x + float(shift[0]), y=s.y + float(shift[1])) for s in self.steps]
        self.feet[done.leg.side] = self.landing.copy()
        for side, foot in enumerate(measured):
            yaw = self.feet[side][2]
            self.feet[side] = np.array([foot[0], foot[1], yaw + wrap(foot[2] - yaw)])
        # Yaws are averaged, so they must not lie a turn apart.
        self.feet[1][2] = self.feet[0][2] + wrap(self.feet[1][2] - self.feet[0][2])
        self.taken += 1
        self.index = done.index + 1
        self._rebuild(self._parameters.double_support * (1 if self.steps else 2))

    def land_now(self, error: Array) -> None:
        """Break the walk off: bring a foot in the air to the ground at once, and stay."""
        self.steps = self.steps[:1] if self.sample.swing is not None else []
        if self.sample.swing is None:
            self._rebuild(2 * self._parameters.double_support)
            return
        self._continue_swing(self.sample.phase, min(self.sample.time_left, _LANDING_TIME))

    def _lift_off(self, step: Footstep) -> None:
        """A foot leaves the ground: keep where it shall land, with a yaw close to its present one."""
        yaw = self.feet[step.leg.side][2]
        self._planned = np.array([step.x, step.y, yaw + wrap(step.yaw - yaw)])
        self.landing = self._planned.copy()
        self._hurried = False

    def _rebuild(self, first: float) -> Sample:
        """Make the reference anew, from both feet on the ground."""
        segments = walking_reference(self._parameters, self.feet, self.steps, self.zmp, first)
        self._reference = Reference(segments, self._omega, self._period)
        self._double_left = first
        self.sample = Sample(self.zmp, self.com, None, 0.0, False, 0.0, False)
        return self.sample

    def _continue_swing(self, phase: float, left: float) -> None:
        """Make the reference anew in the middle of a swing."""
        segments = swinging_reference(
            self._parameters, self.feet, self.steps, (phase, max(left, self._period))
        )
        self._reference = Reference(segments, self._omega, self._period)

    def _problem(self, steps: Sequence[Footstep]) -> str:
        """Why these steps cannot be taken one after the other, or nothing."""
        feet = list(self.feet)
        last: Leg | None = None
        for step in steps:
            if (
                not all(map(math.isfinite, (step.x, step.y, step.yaw, step.step_time)))
                or step.step_time < 0.2
            ):
                return f"step {step.index} holds a number that is no position, angle or time"
            if step.leg is last:
                return f"step {step.index} moves the {step.leg.name.lower()} leg twice in a row"
            x, y = to_frame(feet[step.leg.other.side], step.pose[:2])
            if math.hypot(x, y) > _LONGEST:
                return (
                    f"step {step.index} is {math.hypot(x, y):.2f} m from the other foot; {_LONGEST} m at most"
                )
            if step.leg.sign * y < _NARROWEST:
                return f"step {step.index} comes too close to the other foot"
            feet[step.leg.side] = step.pose
            last = step.leg
        return ""
