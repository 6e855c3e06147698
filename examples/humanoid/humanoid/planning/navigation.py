"""Walking to a pose as an action: plan, follow, plan anew if the robot strays, and report how it ended."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..data import SECOND, STOP_CALLED, Footstep, FootstepPlan, GaitState, Leg, Mode, Stance, Support
from ..robot.ground import Ground
from ..spatial import Array, wrap
from .footsteps import PlanResult, PlanStatus, StepLimits, plan_footsteps
from .walks import STOPPED, GoalTolerance, Outcome, WalkFeedback, WalkResult, WalkTick, halted

_MOST_ROUNDS = 3  # plans that are made after the robot has come to a stand outside the tolerance
_SWINGING = {Support.LEFT: Leg.RIGHT, Support.RIGHT: Leg.LEFT}
_PATIENCE = 2 * SECOND  # ns within which the robot must begin to walk a plan
_RETRY = SECOND  # ns between two attempts to find a way that is free
_MOST_RECOVERIES = 20  # a robot that holds more often than that in a walk has a lasting problem
_NOT_BEGUN = "nobody walks the plan: gait_planner is silent, or the plan was refused"


Planner = Callable[[Stance, Leg | None, int], PlanResult | None]
"""Plans from a stance, with the leg and the index of the first step; None: the plan is not there yet."""


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
        planner: Planner | None = None,
        patience: float = 30.0,
        recovery_time: float = 0.0,
    ) -> None:
        """Plan for a goal; `under_way` is the plan that the robot follows now, if it walks.

        The remaining steps are planned anew once a sole has landed `replan_distance` [m] from its place.
        `planner` plans steps to the goal, straight ones if there is none; when no way is free, the goal is
        given up after `patience` [s].
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
        self._stamp = gait.stamp  # of the last state
        self._planned = gait.stamp  # when the last new plan was made
        self._rounds = 0
        self._recovery = round(recovery_time * SECOND)
        self._recoveries = 0
        self._held: int | None = None  # since when the robot has held
        self._cancelled = self._preempted = False
        self._planner: Planner = planner or self._straight
        self._awaited = False  # a plan, from the planner
        self._blocked = ""  # why there is no way at present
        self._problem = ""  # why there was no plan, the last time
        self._blocked_since = self._retry = gait.stamp
        self._patience = round(patience * SECOND)
        self._plan = under_way or FootstepPlan(0, (), goal)
        self._news: FootstepPlan | None = None
        if not all(math.isfinite(number) and number > 0 for number in self._tolerance):
            self.rejection = "tolerances must be finite and above 0"
            return
        self.rejection = halted(gait)
        if self.rejection:
            return
        result = self._plan_from(gait)
        if result is None:
            self._awaited = True
            return
        self.rejection = (
            "" if result.status in (PlanStatus.PLANNED, PlanStatus.ALREADY_THERE) else result.message
        )
        self._news = result.plan if result.status is PlanStatus.PLANNED else None
        self._plan = self._news or self._plan

    @property
    def steps_ahead(self) -> tuple[Footstep, ...]:
        """The steps of the present plan that have not begun."""
        return tuple(step for step in self._plan.steps if step.index > self._seen)

    def replan(self) -> None:
        """Plan anew from where the robot is, because something has changed."""
        self._awaited = True

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
        before, self._seen = self._seen, gait.footstep_index
        last, self._stamp = self._stamp, gait.stamp
        if gait.footstep_index < before:
            result = self.stopped(gait, _why_less(gait, before, last))
        elif gait.mode is Mode.FALLEN:
            result = self._result(Outcome.FELL, "the robot has fallen", gait)
        elif gait.mode in STOPPED and not self._recovers(gait):
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
            return self._resume(gait)
        elif plan is None:
            return self._go_on(gait)
        return self._tick(gait, plan=plan, stop=stop, result=result)

    def _go_on(self, gait: GaitState) -> WalkTick:
        """Walk on, see whether the robot has arrived or strayed, or see to the plan that is awaited."""
        if not (self._awaited or self._blocked):
            if gait.mode is Mode.STANDING and self._waiting(gait):
                late = gait.stamp - self._planned > _PATIENCE
                return self._tick(gait, result=self.stopped(gait, _NOT_BEGUN) if late else None)
            if gait.mode is Mode.STANDING and (result := self._arrived(gait)) is not None:
                return self._tick(gait, result=result)
            self._awaited = self._awaited or self._strayed(gait)
        return self._ask(gait) if self._awaited or self._blocked else self._tick(gait)

    def _recovers(self, gait: GaitState) -> bool:
        """Whether a robot that has stopped may yet walk on by itself."""
        if gait.mode is not Mode.HOLDING or gait.reason == STOP_CALLED:
            return False
        if self._held is None:
            self._held = gait.stamp
            self._recoveries += 1
        return gait.stamp - self._held < self._recovery and self._recoveries <= _MOST_RECOVERIES

    def _resume(self, gait: GaitState) -> WalkTick:
        """Walk on after holding, once the robot stands."""
        if gait.mode is not Mode.STANDING:
            return self._tick(gait)
        self._held, self._awaited = None, True
        return self._ask(gait)

    def _waiting(self, gait: GaitState) -> bool:
        """Whether the robot stands only because it has not yet begun to walk the plan."""
        return bool(self._plan.steps) and gait.footstep_index <= self._plan.steps[0].index

    def _arrived(self, gait: GaitState) -> WalkResult | None:
        """Decide what follows when the robot stands: it has arrived, plans again, or has missed the goal."""
        centre = gait.stance.centre
        distance, angle = self._distance(centre), abs(wrap(centre[2] - self.goal[2]))
        if distance <= self._tolerance.position and angle <= self._tolerance.yaw:
            return self._result(Outcome.REACHED, "", gait)
        if self._rounds < _MOST_ROUNDS:
            self._rounds += 1
            self._awaited = True
            return None
        off = f"{distance * 1e3:.0f} mm and {math.degrees(angle):.1f} degrees off"
        return self._result(Outcome.MISSED, self._problem or off, gait)

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

    def _ask(self, gait: GaitState) -> WalkTick:
        """Get the plan that is awaited, or wait for a way that is free."""
        if self._blocked and not self._awaited:
            if gait.mode is not Mode.STANDING:
                return self._tick(gait, stop=True)
            if gait.stamp - self._blocked_since > self._patience:
                return self._tick(gait, result=self._result(Outcome.UNREACHABLE, self._blocked, gait))
            if gait.stamp < self._retry:
                return self._tick(gait)
        self._retry = gait.stamp + _RETRY
        answer = self._plan_from(gait)
        self._awaited = answer is None
        if answer is None:
            return self._tick(gait, stop=bool(self._blocked))
        self._problem = answer.message
        if answer.status is PlanStatus.PLANNED:
            self._blocked, self._plan = "", answer.plan
            return self._tick(gait, plan=answer.plan)
        if answer.status is PlanStatus.BLOCKED:
            if not self._blocked:
                self._blocked_since = gait.stamp
            self._blocked = answer.message
            return self._tick(gait, stop=True)
        if answer.status is PlanStatus.ALREADY_THERE:
            self._blocked = ""
        return self._tick(gait)

    def _tick(
        self,
        gait: GaitState,
        *,
        plan: FootstepPlan | None = None,
        stop: bool = False,
        result: WalkResult | None = None,
    ) -> WalkTick:
        if plan is not None:
            self._planned = gait.stamp
        return WalkTick(
            plan,
            stop,
            self._feedback(gait, plan is not None or self._awaited or self._held is not None),
            result,
        )

    def _plan_from(self, gait: GaitState) -> PlanResult | None:
        """A plan from the present stance, or from the one that the step in the air leads to."""
        swinging = _SWINGING.get(gait.stance.support)
        ahead = [step for step in self._plan.steps if step.index == gait.footstep_index]
        if swinging is None and gait.mode not in (Mode.STANDING, Mode.DANCING) and ahead:
            swinging = ahead[0].leg  # the weight is already moving: that step will be taken
        if swinging is None or not ahead or ahead[0].leg is not swinging:
            return self._planner(gait.stance, None, gait.footstep_index)
        feet = list(gait.stance.feet)
        feet[swinging.side] = ahead[0].pose
        result = self._planner(
            Stance(Support.BOTH, (feet[0], feet[1])), swinging.other, gait.footstep_index + 1
        )
        if result is None:
            return None
        return replace(result, plan=replace(result.plan, steps=(ahead[0], *result.plan.steps)))

    def _straight(self, start: Stance, first_leg: Leg | None, first_index: int) -> PlanResult:
        """A plan that leads straight to the goal."""
        return plan_footsteps(
            start,
            self.goal,
            limits=self._limits,
            ground=self._ground,
            first_leg=first_leg,
            first_index=first_index,
        )

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


def _why_less(gait: GaitState, before: int, last: int) -> str:
    """The reason why the controller counts fewer steps than `before`, at a state with the stamp `last`."""
    if gait.stamp < last:
        return "the simulation has started again"
    if not gait.plan_id and gait.mode not in (Mode.WALKING, Mode.STOPPING):  # it has followed no plan yet
        return "whole_body_controller has restarted"
    return (
        f"the robot walks a plan that counts its steps anew, {gait.footstep_index} after {before}: "
        "plans for one walk continue the count"
    )
