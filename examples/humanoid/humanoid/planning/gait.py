"""The gait planner: decides the next steps, from plans, velocities and requests to stop.

It has no clock and no model: the controller's GaitState says which step is under way. Each plan that it
returns replaces the one before; the step in the air is always its first.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..control.pace import Pace
from ..data import Footstep, FootstepPlan, GaitState, Leg, Mode, Stance, Support
from ..spatial import Array, from_frame, wrap
from .footsteps import StepLimits, advance, beside, footstep, is_easy

_AHEAD = 3  # steps that are planned from a velocity, before the one that joins the feet
_STANDING = {Mode.STANDING, Mode.HOLDING, Mode.FALLEN, Mode.EMERGENCY_STOP}
_SWINGING = {Support.LEFT: Leg.RIGHT, Support.RIGHT: Leg.LEFT}


class GaitPlanner:
    """Turns requests for the gait into the plan that the controller follows."""

    def __init__(
        self, limits: StepLimits | None = None, double_support: float = Pace().double_support
    ) -> None:
        self._limits = limits or StepLimits()
        self._step_period = self._limits.step_time + double_support
        self._plan = FootstepPlan(0, (), (0.0, 0.0, 0.0))
        self._news = False
        self._velocity = np.zeros(3)
        self._steering = False  # whether by velocity, until the robot stands again
        self._stopping = False

    @property
    def plan(self) -> FootstepPlan:
        """The plan returned last."""
        return self._plan

    def walk(self, plan: FootstepPlan) -> None:
        """Walk a plan from now on; it replaces any earlier plan or velocity."""
        self._steering = self._stopping = False
        self._publish(plan.steps, plan.goal)

    def velocity(self, forward: float, left: float, turn: float) -> str:
        """Walk at a velocity (m/s, m/s, rad/s in base_footprint), as closely as steps allow; zero stops.

        Returns why not, or "".
        """
        wanted = np.array([forward, left, turn])
        if not np.isfinite(wanted).all():
            return "/humanoid/cmd_vel holds a number that is not finite"
        if wanted.any():
            self._steering, self._stopping = True, False
        elif self._steering:
            self._stopping = True
        self._velocity = wanted
        return ""

    def cancel(self) -> None:
        """Stop: finish the step in the air and put the other foot beside it."""
        self._stopping = True

    def update(self, state: GaitState) -> FootstepPlan | None:
        """Take the controller's newest state; returns the plan to publish, if there is a new one."""
        if state.plan_id > self._plan.plan_id:  # of an earlier gait planner
            self._plan = replace(self._plan, plan_id=state.plan_id + self._news)
        if self._stopping:
            self._join(state)
            # Plan and state may have crossed: what counts is that the robot has come to a stand with its feet
            # side by side.
            if state.mode is Mode.STANDING and not self._plan.steps:
                self._steering = self._stopping = False
        elif self._steering and state.mode not in _STANDING - {Mode.STANDING}:
            self._steer(state)
        if not self._news:
            return None
        self._news = False
        return self._plan

    def _publish(self, steps: tuple[Footstep, ...], goal: tuple[float, float, float]) -> None:
        if steps != self._plan.steps or self._plan.plan_id == 0:
            self._plan = FootstepPlan(self._plan.plan_id + 1, steps, goal)
            self._news = True

    def _join(self, state: GaitState) -> None:
        """Publish the steps that end the walk with the feet side by side."""
        under_way = self._under_way(state)
        feet = [foot.copy() for foot in state.stance.feet]
        steps: list[Footstep] = []
        leg = None
        if state.mode not in _STANDING:
            if under_way is not None:
                steps.append(under_way)
                feet[under_way.leg.side] = under_way.pose
                leg = under_way.leg.other
            else:
                leg = self._next_leg(state)
        if leg is not None and not _parallel(feet[0], feet[1], self._limits.width):
            base = _body_of(feet[leg.other.side], leg.other, self._limits.width)
            index = state.footstep_index + len(steps)
            same = [step for step in self._plan.steps if step.index == index and step.leg is leg]
            join = footstep(index, leg, base, self._limits)
            # The soles are measured anew at each tick; plans that differ only by that are the same plan.
            steps.append(same[0] if same and _alike(same[0], join) else join)
        elif leg is not None and under_way is None and state.mode is not Mode.STANDING:
            steps = []
        last = Stance(Support.BOTH, (feet[0], feet[1])).centre
        self._publish(tuple(steps), (float(last[0]), float(last[1]), float(last[2])))

    def _steer(self, state: GaitState) -> None:
        """Publish the next steps at the wanted velocity."""
        steps: list[Footstep] = []
        under_way = self._under_way(state)
        if under_way is not None:
            steps.append(under_way)
            base, leg = _body_of(under_way.pose, under_way.leg, self._limits.width), under_way.leg.other
        elif state.mode is Mode.STANDING:
            base = state.stance.centre
            sideways = self._velocity[1] or self._velocity[2]
            leg = Leg.LEFT if sideways > 0 else Leg.RIGHT
            if not is_easy(state.stance, self._ahead(base, leg, 0)[0], self._limits):
                leg = leg.other
        else:
            if self._plan.steps and self._plan.steps[0].index == state.footstep_index:
                return  # the weight is already moving: wait for the foot to leave the ground
            leg = self._next_leg(state)
            base = _body_of(state.stance.feet[leg.other.side], leg.other, self._limits.width)
        steps += self._ahead(base, leg, state.footstep_index + len(steps))
        if not _same_steps(steps, self._plan.steps):
            goal = _body_of(steps[-1].pose, steps[-1].leg, self._limits.width)
            self._publish(tuple(steps), (float(goal[0]), float(goal[1]), float(goal[2])))

    def _ahead(self, base: Array, leg: Leg, index: int) -> list[Footstep]:
        """The next steps at the wanted velocity, and the one that joins the feet."""
        motion = self._velocity * self._step_period
        motion[1] *= 2  # only every other step moves sideways
        steps: list[Footstep] = []
        for _ in range(_AHEAD):
            base = advance(base, leg, motion, self._limits)
            steps.append(footstep(index + len(steps), leg, base, self._limits))
            leg = leg.other
        return [*steps, footstep(index + len(steps), leg, base, self._limits)]

    def _under_way(self, state: GaitState) -> Footstep | None:
        """The step whose foot is in the air, with its planned landing."""
        leg = _SWINGING.get(state.stance.support)
        if leg is None:
            return None
        for step in self._plan.steps:
            if step.index == state.footstep_index and step.leg is leg:
                return step
        x, y, yaw = (float(part) for part in state.stance.feet[leg.side])
        return Footstep(state.footstep_index, leg, x, y, yaw, self._limits.step_time)

    def _next_leg(self, state: GaitState) -> Leg:
        """The leg that moves next while both feet are down."""
        for step in self._plan.steps:
            if step.index == state.footstep_index:
                return step.leg
        left, right = state.stance.feet
        forward = from_frame(np.array([0.0, 0.0, -left[2]]), left[:2] - right[:2])[0]
        return Leg.RIGHT if forward > 0 else Leg.LEFT


def _body_of(foot: Array, leg: Leg, width: float) -> Array:
    """Planar pose of the body if it stands beside this foot."""
    x, y = from_frame(foot, np.array([0.0, -leg.sign * width / 2]))
    return np.array([x, y, foot[2]])


def _parallel(left: Array, right: Array, width: float) -> bool:
    """Whether two feet are side by side, as precisely as a foot lands: within 30 mm and 0.08 rad."""
    wanted = beside(_body_of(left, Leg.LEFT, width), Leg.RIGHT, width)
    return math.hypot(*(wanted - right)[:2]) < 0.03 and abs(wrap(wanted[2] - right[2])) < 0.08


def _alike(one: Footstep, other: Footstep) -> bool:
    """Whether two steps are the same up to measurement errors: 10 mm and 0.02 rad."""
    return (
        (one.index, one.leg) == (other.index, other.leg)
        and math.hypot(one.x - other.x, one.y - other.y) < 0.01
        and abs(wrap(one.yaw - other.yaw)) < 0.02
    )


def _same_steps(steps: list[Footstep], others: tuple[Footstep, ...]) -> bool:
    return len(steps) == len(others) and all(map(_alike, steps, others))
