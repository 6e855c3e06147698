"""Walking to a pose as an action: plan, follow, plan anew if the robot strays, and report how it ended."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from ..data import SECOND, STOP_CALLED, FootstepPlan, GaitState, Leg, Mode, Stance, Support
from ..robot.ground import Ground
from ..spatial import Array, wrap
from .footsteps import PlanResult, PlanStatus, StepLimits, plan_footsteps

_MOST_ROUNDS = 3  # plans that are made after the robot has come to a stand outside the tolerance
_SWINGING = {Support.LEFT: Leg.RIGHT, Support.RIGHT: Leg.LEFT}
_STOPPED = {Mode.HOLDING, Mode.EMERGENCY_STOP}
_PATIENCE = 2 * SECOND  # ns within which the robot must begin to walk a plan
_MOST_RECOVERIES = 20  # a robot that holds more often than that in a walk has a lasting problem
_NOT_BEGUN = "nobody walks the plan: gait_planner is silent, or the plan was refused"


def halted(gait: GaitState) -> str:
    """The reason why the robot accepts no goals now, or ""."""
    if gait.mode not in _STOPPED | {Mode.FALLEN}:
        return ""
    return f"the robot accepts no goals: {gait.reason}"


class GoalTolerance(NamedTuple):
    """The errors that count as arrived: metres and radians."""

    position: float = 0.03
    yaw: float = 0.05


class Outcome(IntEnum):
    """The outcome of a walk, as in WalkTo.action."""

    UNKNOWN = 0
    REACHED = 1
    MISSED = 2
    CANCELED = 3
    PREEMPTED = 4
    UNREACHABLE = 5
    STOPPED = 6
    FELL = 7


@dataclass(frozen=True, slots=True)
class WalkFeedback:
    """The feedback of WalkTo.action."""

    pose: Array  # planar pose of base_footprint
    distance_left: float
    replanning: bool
    steps_taken: int
    steps_left: int


@dataclass(frozen=True, slots=True)
class WalkResult:
    """The result of WalkTo.action; `time` in seconds."""

    outcome: Outcome
    message: str
    pose: Array
    steps: int
    time: float


@dataclass(frozen=True, slots=True)
class WalkTick:
    """The messages to send after an update: a plan for the gait planner, or a request to stop."""

    plan: FootstepPlan | None
    stop: bool
    feedback: WalkFeedback
    result: WalkResult | None


class Navigation:
    """A goal under way. `rejection` says why it must not be accepted, or is ""."""

    def __init__(  # noqa: PLR0913  # each is a parameter of the node, or of the goal
        self,
        goal: tuple[float, float, float],
        gait: GaitState,
        under_way: FootstepPlan | None = None,
        *,
        limits: StepLimits | None = None,
        ground: Ground | None = None,
        tolerance: GoalTolerance | None = None,
        replan_distance: float = 0.05,
        recovery_time: float = 0.0,
    ) -> None:
        """Plan for a goal; `under_way` is the plan that the robot follows now, if it walks.

        The remaining steps are planned anew once a sole has landed `replan_distance` [m] from its place.
        A robot that has to hold, because readings or a node are missing, is awaited for `recovery_time` [s],
        and walks on from where it is then.
        """
        self.goal = goal
        self._limits = limits or StepLimits()
        self._ground = ground or Ground()
        self._tolerance = tolerance or GoalTolerance()
        self._replan_distance = replan_distance
        self._begun, self._first_index = gait.stamp, gait.footstep_index
        self._checked = self._seen = gait.footstep_index
        self._planned = gait.stamp  # when the last new plan was made
        self._rounds = 0
        self._recovery = round(recovery_time * SECOND)
        self._recoveries = 0
        self._held: int | None = None  # since when the robot has held
        self._cancelled = self._preempted = False
        self._plan = under_way or FootstepPlan(0, (), goal)
        self._news: FootstepPlan | None = None
        if not all(math.isfinite(number) and number > 0 for number in self._tolerance):
            self.rejection = "tolerances must be finite and above 0"
            return
        self.rejection = halted(gait)
        if self.rejection:
            return
        result = self._plan_from(gait)
        self.rejection = (
            "" if result.status in (PlanStatus.PLANNED, PlanStatus.ALREADY_THERE) else result.message
        )
        self._news = result.plan if result.status is PlanStatus.PLANNED else None
        self._plan = self._news or self._plan

    def cancel(self) -> None:
        """Stop as soon as the feet can stand side by side."""
        self._cancelled = True

    def preempt(self) -> None:
        """Let another goal take over: end at once, while the robot walks on."""
        self._preempted = True

    def stopped(self, gait: GaitState, why: str) -> WalkResult:
        """The result if something else ends the walk; `gait` is the last state of the controller."""
        return self._result(Outcome.STOPPED, why, gait)

    def update(self, gait: GaitState) -> WalkTick:
        """Take the newest gait state; returns what to send."""
        plan, self._news = self._news, None
        result, stop = None, False
        anew, self._seen = gait.footstep_index < self._seen, gait.footstep_index
        if anew:
            result = self.stopped(gait, "whole_body_controller has restarted")
        elif gait.mode is Mode.FALLEN:
            result = self._result(Outcome.FELL, "the robot has fallen", gait)
        elif gait.mode in _STOPPED and not self._recovers(gait):
            result = self.stopped(gait, gait.reason)
        elif self._preempted:
            result = self._result(Outcome.PREEMPTED, "a later goal took over", gait)
        elif self._cancelled:
            stop, plan = True, None
            if gait.mode in (Mode.STANDING, Mode.HOLDING):
                result = self._result(Outcome.CANCELED, "canceled", gait)
        elif gait.mode is Mode.HOLDING:
            stop, plan = True, None
        elif self._held is not None:
            plan, result = self._go_on(gait)
        elif plan is None and gait.mode is Mode.STANDING and self._waiting(gait):
            if gait.stamp - self._planned > _PATIENCE:
                result = self.stopped(gait, _NOT_BEGUN)
        elif plan is None and gait.mode is Mode.STANDING:
            plan, result = self._arrived(gait)
        elif plan is None and self._strayed(gait):
            again = self._plan_from(gait)
            if again.status is PlanStatus.PLANNED:
                plan = self._plan = again.plan
        if plan is not None:
            self._planned = gait.stamp
        return WalkTick(plan, stop, self._feedback(gait, plan is not None or self._held is not None), result)

    def _recovers(self, gait: GaitState) -> bool:
        """Whether a robot that has stopped may yet walk on by itself."""
        if gait.mode is not Mode.HOLDING or gait.reason == STOP_CALLED:
            return False
        if self._held is None:
            self._held = gait.stamp
            self._recoveries += 1
        return gait.stamp - self._held < self._recovery and self._recoveries <= _MOST_RECOVERIES

    def _go_on(self, gait: GaitState) -> tuple[FootstepPlan | None, WalkResult | None]:
        """Walk on after holding, once the robot stands."""
        if gait.mode is not Mode.STANDING:
            return None, None
        self._held = None
        result = self._plan_from(gait)
        if result.status is PlanStatus.PLANNED:
            self._plan = result.plan
            return result.plan, None
        if result.status is PlanStatus.ALREADY_THERE:
            return self._arrived(gait)
        return None, self._result(Outcome.UNREACHABLE, result.message, gait)

    def _waiting(self, gait: GaitState) -> bool:
        """Whether the robot stands only because it has not yet begun to walk the plan."""
        return bool(self._plan.steps) and gait.footstep_index <= self._plan.steps[0].index

    def _arrived(self, gait: GaitState) -> tuple[FootstepPlan | None, WalkResult | None]:
        """Decide what follows when the robot stands: it has arrived, walks on, or has missed the goal."""
        centre = gait.stance.centre
        distance, angle = self._distance(centre), abs(wrap(centre[2] - self.goal[2]))
        if distance <= self._tolerance.position and angle <= self._tolerance.yaw:
            return None, self._result(Outcome.REACHED, "", gait)
        message = f"{distance * 1e3:.0f} mm and {math.degrees(angle):.1f} degrees off"
        if self._rounds < _MOST_ROUNDS:
            self._rounds += 1
            result = self._plan_from(gait)
            if result.status is PlanStatus.PLANNED:
                self._plan = result.plan
                return result.plan, None
            message = result.message
        return None, self._result(Outcome.MISSED, message, gait)

    def _strayed(self, gait: GaitState) -> bool:
        """Whether the last step landed so far from its place that the rest of the plan no longer fits."""
        if gait.stance.support is Support.BOTH or gait.footstep_index == self._checked:
            return False
        self._checked = gait.footstep_index
        for step in self._plan.steps:
            if step.index == gait.footstep_index - 1:
                off = math.hypot(*(gait.stance.feet[step.leg.side] - step.pose)[:2])
                return off > self._replan_distance
        return False

    def _plan_from(self, gait: GaitState) -> PlanResult:
        """A plan from the present stance, or from the one that the step in the air leads to."""
        swinging = _SWINGING.get(gait.stance.support)
        ahead = [step for step in self._plan.steps if step.index == gait.footstep_index]
        if swinging is None and gait.mode not in (Mode.STANDING, Mode.DANCING) and ahead:
            swinging = ahead[0].leg  # the weight is already moving: that step will be taken
        if swinging is None or not ahead or ahead[0].leg is not swinging:
            return plan_footsteps(
                gait.stance,
                self.goal,
                limits=self._limits,
                ground=self._ground,
                first_index=gait.footstep_index,
            )
        feet = list(gait.stance.feet)
        feet[swinging.side] = ahead[0].pose
        result = plan_footsteps(
            Stance(Support.BOTH, (feet[0], feet[1])),
            self.goal,
            limits=self._limits,
            ground=self._ground,
            first_leg=swinging.other,
            first_index=gait.footstep_index + 1,
        )
        return replace(result, plan=replace(result.plan, steps=(ahead[0], *result.plan.steps)))

    def _feedback(self, gait: GaitState, replanning: bool) -> WalkFeedback:
        left = sum(step.index >= gait.footstep_index for step in self._plan.steps)
        centre = gait.stance.centre
        taken = gait.footstep_index - self._first_index
        return WalkFeedback(centre, self._distance(centre), replanning, taken, left)

    def _result(self, outcome: Outcome, message: str, gait: GaitState) -> WalkResult:
        seconds = max(gait.stamp - self._begun, 0) / SECOND  # time goes back if the simulator starts again
        return WalkResult(
            outcome, message, gait.stance.centre, gait.footstep_index - self._first_index, seconds
        )

    def _distance(self, pose: Array) -> float:
        return float(np.hypot(pose[0] - self.goal[0], pose[1] - self.goal[1]))
