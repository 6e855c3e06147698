"""The places of the feet and the next step: footsteps, their reference, and changes during the walk."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..data import Footstep, FootstepPlan, Leg, Stance, Support
from ..robot.model import SoleGeometry
from ..spatial import Array, from_frame, to_frame, wrap
from . import swing
from .balance import limits, usable
from .pace import SHORTEST_TIME
from .reference import GaitParameters, Reference, Sample, middle, swinging_reference, walking_reference
from .support import beyond, support_polygon

_ADJUSTABLE = 0.9  # share of a swing until which its landing may still move
_ONLY_OUTWARDS = 0.5  # share of a swing after which its landing no longer comes nearer to the other foot
_MOVED = 0.01  # metres by which a landing must have moved before the later steps move with it
_NARROWEST = 0.11  # metres sideways between the soles
# A swing is hurried at these errors of the DCM [m]: outwards, inwards, along; but not within this time [s] of
# its end.
_FALLING_OUT, _FALLING_IN, _FALLING_ALONG, _SOON = 0.035, 0.06, 0.10, 0.25
_HURRY, _SHORTEST = 0.45, 0.22  # share of the remaining time that a hurried swing takes, and its minimum [s]
_CATCH_TIME = 0.27  # seconds of a swing that catches a robot that stood
_BRIEF = 0.06  # seconds of double support while a falling robot takes its steps sooner
_LOST = 0.01  # metres of the DCM outside the soles: it will not return without a step
_UNMOVED = 0.03  # metres of its error at which that need not be looked for
_LOST_LANDED = 0.04  # the same for a robot that has just come to a stand: it sways, and stays if it can
_LEASH = 0.04  # metres between the centre of mass and its reference
_SETTLING_TIME, _SETTLING_SPEED = 0.2, 0.05  # s at least, and m/s, until the weight is between the feet
_LANDING_TIME = 0.3  # seconds until an interrupted swing touches the ground


class Stepping:
    """Follows footsteps in time. All poses are in the world; `period` is the control period [s]."""

    def __init__(self, parameters: GaitParameters, omega: float, period: float, sole: SoleGeometry) -> None:
        self._parameters, self._omega, self._period = parameters, omega, period
        self._low, self._high = limits(sole, parameters)
        self._usable = usable(sole, parameters)
        self.plan_id = 0
        self.index = 0  # of the present or next step
        self.taken = 0
        self._double_left = 0.0  # seconds until the next foot may leave the ground
        self._hurried = False  # the present swing
        self._landed = False  # the walk was broken off
        self.adjusted = 0  # landings that were moved to keep balance
        half = parameters.stance_width / 2
        self.stand([np.array([0.0, side, 0.0]) for side in (half, -half)])

    def stand(self, feet: Sequence[Array], com: Array | None = None) -> None:
        """Start again, standing on both feet (planar poses).

        The centre of mass moves from where it is (2,) to between them, without haste.
        """
        self.feet = [foot.copy() for foot in feet]
        self.steps: list[Footstep] = []
        between = middle(feet, self._parameters)
        self.zmp = between if com is None else com.copy()
        self.com: Array = self.zmp.copy()  # reference of the centre of mass, (2,)
        self.sample = self._rebuild(max(_SETTLING_TIME, math.dist(self.zmp, between) / _SETTLING_SPEED))

    @property
    def standing(self) -> bool:
        """Whether no step is under way or planned, and the weight is between the feet."""
        return not self.steps and self._reference.over

    @property
    def stance(self) -> Stance:
        """The feet of the reference, and which of them carry."""
        moving = self.sample.swing
        support = Support.BOTH if moving is None else (Support.RIGHT, Support.LEFT)[moving.leg.side]
        return Stance(support, (self.feet[0].copy(), self.feet[1].copy()))

    def follow(self, plan: FootstepPlan) -> str:
        """Take the steps of a plan from now on; returns why it cannot, or "".

        The step under way is finished first. If the plan was made before that step began, its steps up to
        the index of the present step count as taken.
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
        self._landed = False
        self.plan_id = plan.plan_id
        self.steps = steps
        if moving is not None:
            self._continue_swing(self.sample.phase, self.sample.time_left - self._period)
        elif steps and not before:
            self._rebuild(self._parameters.first_double_support)
        elif steps:
            self._rebuild(self._double_left)  # the weight continues to move to the same foot
        elif before:
            self._rebuild(2 * self._parameters.double_support)
        self.index = steps[0].index if steps else self.index
        return ""

    def next(self) -> Sample:
        """Return the reference of the next control tick and advance the reference of the centre of mass."""
        sample = self._reference.next()
        if sample.swing is not None and (self.sample.swing is not sample.swing):
            self._lift_off(sample.swing)
        self._double_left = max(0.0, self._double_left - self._period)
        self.velocity = self._omega * (sample.dcm - self.com)
        self.com = self.com + self.velocity * self._period
        self.zmp = sample.zmp
        self.sample = sample
        return sample

    def keep_near(self, com: Array) -> None:
        """Keep the reference of the centre of mass near the measured one (2,).

        The reference of the DCM does not change. Servos that pull the body back by more than the sole can
        hold would tilt it.
        """
        way = self.com - com
        length = math.hypot(way[0], way[1])
        if length > _LEASH:
            self.com = com + way * (_LEASH / length)

    def adjust(self, error: Array) -> None:
        """Move the landing of the present swing so that it catches an error of the DCM (2,)."""
        moving, sample = self.sample.swing, self.sample
        if moving is None:
            self._adjust_standing(error)
            return
        if sample.phase >= _ADJUSTABLE:
            return
        stance = self.feet[moving.leg.other.side]
        if not self._hurried and sample.time_left > _SOON and self._falling(moving.leg, error):
            self._hurry(stance)
        local = to_frame(stance, sample.zmp)
        target = swing.adjusted_landing(
            self._planned[:2],
            stance,
            moving.leg.sign,
            error,
            (self._low - local, self._high - local),
            math.exp(self._omega * sample.time_left),
        )
        if sample.phase > _ONLY_OUTWARDS:
            target = swing.not_inwards(self.landing[:2], target, stance, moving.leg.sign)
        self.landing[:2] = swing.moved(self.landing[:2], target, sample.phase, self._period)

    def _falling(self, leg: Leg, error: Array) -> bool:
        """Whether the robot falls faster than a moved landing can catch, so that the leg must land sooner.

        The worst direction is outside the stance foot, where no step can catch it. `error` (2,) is the DCM's.
        """
        along, left = to_frame(np.array([0.0, 0.0, self.feet[leg.other.side][2]]), error)
        inwards = leg.sign * left
        if self.sample.swing is None:
            return bool(inwards < -_FALLING_OUT)
        return bool(inwards < -_FALLING_OUT or inwards > _FALLING_IN or abs(along) > _FALLING_ALONG)

    def _hurry(self, stance: Array) -> None:
        """Land sooner, and nearer by the distance that the reference will not cover in the shorter time."""
        left = max(_SHORTEST, _HURRY * self.sample.time_left)
        growth = math.exp(self._omega * left) - math.exp(self._omega * self.sample.time_left)
        ahead = np.array([math.cos(stance[2]), math.sin(stance[2])])
        x, y = growth * float((self.sample.dcm - self.sample.zmp) @ ahead) * ahead
        self._hurried = True
        self.steps = [replace(step, x=step.x + float(x), y=step.y + float(y)) for step in self.steps]
        self._planned[:2] += (x, y)
        self._continue_swing(self.sample.phase, left)

    def _adjust_standing(self, error: Array) -> None:
        """With both feet on the ground, step, or step sooner, if the soles cannot hold the robot."""
        if self.steps:
            if self._double_left > _BRIEF and self._falling(self.steps[0].leg, error):
                self._rebuild(_BRIEF)
            return
        if math.hypot(error[0], error[1]) < _UNMOVED:
            return
        dcm = self.sample.dcm + error
        if beyond(dcm, support_polygon(self.feet, self._usable)) > (_LOST_LANDED if self._landed else _LOST):
            self._catch(min(Leg, key=lambda leg: self._lost_by(leg, dcm)))

    def _lost_by(self, leg: Leg, dcm: Array) -> float:
        """How far the DCM (2,) will be outside the soles when this leg has taken a quick step [m].

        Until then it runs away from the other sole, whose nearest point the ZMP takes.
        """
        stance = self.feet[leg.other.side]
        point = to_frame(stance, dcm)
        zmp = np.clip(point, self._low, self._high)
        there = zmp + (point - zmp) * math.exp(self._omega * (_BRIEF + _CATCH_TIME))
        landing = np.array([*swing.within_reach(there, leg.sign), 0.0])
        return beyond(there, support_polygon([np.zeros(3), landing], self._usable))

    def targets(self) -> list[tuple[Array, float]]:
        """Planar pose and height of both soles at this tick."""
        poses = [(foot, 0.0) for foot in self.feet]
        if self.sample.swing is not None:
            side = self.sample.swing.leg.side
            poses[side] = swing.foot_pose(
                self.feet[side], self.landing, self.sample.phase, self._parameters.lift
            )
        return poses

    def accelerations(self) -> list[Array]:
        """Accelerations (6,) of both soles at this tick, linear then angular."""
        found = [np.zeros(6), np.zeros(6)]
        if (moving := self.sample.swing) is not None:
            side, sample = moving.leg.side, self.sample
            found[side] = swing.acceleration(
                self.feet[side], self.landing, sample.phase, sample.time_left, self._parameters.lift
            )
        return found

    def touchdown(self, measured: Sequence[Array]) -> None:
        """End the swing: continue from where the soles (planar poses) really are."""
        done = self.steps.pop(0)
        shift = self.landing[:2] - self._planned[:2]
        if math.hypot(*shift) > _MOVED:
            self.adjusted += 1
            self.steps = [replace(s, x=s.x + float(shift[0]), y=s.y + float(shift[1])) for s in self.steps]
        self.feet[done.leg.side] = self.landing.copy()
        for side, foot in enumerate(measured):
            yaw = self.feet[side][2]
            self.feet[side] = np.array([foot[0], foot[1], yaw + wrap(foot[2] - yaw)])
        # Yaws are averaged, so they must not be a full turn apart.
        self.feet[1][2] = self.feet[0][2] + wrap(self.feet[1][2] - self.feet[0][2])
        self.taken += 1
        self.index = done.index + 1
        double = _BRIEF if self._hurried else self._parameters.double_support
        self._rebuild(double if self.steps else 2 * self._parameters.double_support)

    def _catch(self, leg: Leg) -> None:
        """Take two unplanned steps: this leg first, then the other one beside it."""
        x, y, yaw = (float(part) for part in self.feet[leg.side])
        self.steps = [Footstep(self.index, leg, x, y, yaw)]
        x, y = from_frame(self.feet[leg.side], np.array([0.0, -leg.sign * self._parameters.stance_width]))
        self.steps.append(Footstep(self.index + 1, leg.other, float(x), float(y), yaw))
        self._rebuild(_BRIEF)

    def land_now(self) -> None:
        """Break off the walk: bring a foot in the air to the ground at once, and stay."""
        self.steps = self.steps[:1] if self.sample.swing is not None else []
        self._landed = True
        if self.sample.swing is None:
            self._rebuild(2 * self._parameters.double_support)
            return
        self._continue_swing(self.sample.phase, min(self.sample.time_left, _LANDING_TIME))

    def _lift_off(self, step: Footstep) -> None:
        """Let a foot leave the ground: keep its landing pose, with a yaw close to its present one."""
        yaw = self.feet[step.leg.side][2]
        self._planned = np.array([step.x, step.y, yaw + wrap(step.yaw - yaw)])
        self.landing = self._planned.copy()
        self._hurried = False

    def _rebuild(self, first: float) -> Sample:
        """Rebuild the reference with both feet on the ground."""
        segments = walking_reference(self._parameters, self.feet, self.steps, self.zmp, first)
        self._reference = Reference(segments, self._omega, self._period)
        self._double_left = first
        self.sample = Sample(self.zmp, self.com, None, 0.0, False, 0.0, False)
        return self.sample

    def _continue_swing(self, phase: float, left: float) -> None:
        """Rebuild the reference in the middle of a swing, which continues for `left` seconds."""
        left = max(left, self._period)
        segments = swinging_reference(self._parameters, self.feet, self.steps, (phase, left))
        self._reference = Reference(segments, self._omega, self._period)
        # It is still the same swing, and a plan that arrives before the next tick must not undo the hurry.
        self.sample = replace(self.sample, swing=self.steps[0], time_left=left + self._period)

    def _problem(self, steps: Sequence[Footstep]) -> str:
        """The reason why these steps cannot be taken one after another, or ""."""
        feet = list(self.feet)
        last: Leg | None = None
        for step in steps:
            if not all(map(math.isfinite, (step.x, step.y, step.yaw, step.step_time))):
                return f"step {step.index} holds a number that is not a position, angle or time"
            if step.step_time < SHORTEST_TIME:
                return f"step {step.index} takes {step.step_time:.2f} s; {SHORTEST_TIME:g} s at least"
            if step.leg is last:
                return f"step {step.index} moves the {step.leg.name.lower()} leg twice in a row"
            x, y = to_frame(feet[step.leg.other.side], step.pose[:2])
            if (length := math.hypot(x, y)) > (reach := self._parameters.reach):
                return (
                    f"step {step.index} is {length:.2f} m from the other foot; {reach:.2f} m at most"
                    " at this walking_speed"
                )
            if step.leg.sign * y < _NARROWEST:
                return f"step {step.index} comes too close to the other foot"
            feet[step.leg.side] = step.pose
            last = step.leg
        return ""
