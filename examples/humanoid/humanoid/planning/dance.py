"""A dance as an action: from standing to standing, beat by beat, with its feedback and its result."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from ..data import SECOND, Footstep, FootstepPlan, GaitState, JointStates, Leg, Mode, Posture, Support
from ..robot.body import OURS, Body
from ..robot.table import UPPER_BODY
from ..spatial import Array
from .choreography import DANCES, Beat, blend, standing_posture
from .footsteps import StepLimits, advance, fitted, footstep

TEMPO = (30.0, 140.0)  # beats per minute that the arms can follow
_PREPARE = 1.5  # seconds from standing to the first beat's pose, and back at the end
_BROKEN = {Mode.HOLDING, Mode.FALLEN, Mode.EMERGENCY_STOP}


class DancePhase(IntEnum):
    """The phase of a dance, as in PerformDance.action."""

    UNKNOWN = 0
    PREPARING = 1
    DANCING = 2
    RETURNING = 3


@dataclass(slots=True)
class DanceFeedback:
    """The feedback of PerformDance.action."""

    beat: int
    phase: DancePhase
    progress: float
    joint_error: float  # root mean square over waist, head and arms, rad


@dataclass(frozen=True, slots=True)
class DanceResult:
    """The result of PerformDance.action; `time` in seconds."""

    completed: bool
    message: str
    steps: int
    beats: int
    time: float
    joint_error: float


@dataclass(slots=True)
class DanceTick:
    """The messages to send after an update. Without a posture the controller returns to its own."""

    posture: Posture | None
    plan: FootstepPlan | None
    feedback: DanceFeedback
    result: DanceResult | None


def problem(dance: str, tempo: float, known: Collection[str] = DANCES.keys(), body: Body = OURS) -> str:
    """The reason why a goal must be rejected, or ""; `known` names the accepted ones of DANCES."""
    if dance not in known:
        return f"there is no dance '{dance}'; I know {', '.join(sorted(known))}"
    if lacking := DANCES[dance].lacking(body):
        return f"the robot has no joint {lacking}, which '{dance}' moves"
    if tempo and not (math.isfinite(tempo) and TEMPO[0] <= tempo <= TEMPO[1]):
        return f"{tempo:g} beats per minute cannot be danced; {TEMPO[0]:g} to {TEMPO[1]:g} can"
    return ""


class Dance:
    """A dance under way. The caller must reject goals for which `problem` finds a reason."""

    def __init__(self, dance: str, tempo: float, beats: int, stamp: int, body: Body = OURS) -> None:
        choreography = DANCES[dance]
        self._limits = fitted(StepLimits(turn=0.30, trailing_turn=0.15), body)
        self._beats = choreography.beats
        self._count = beats or len(self._beats)
        self._period = 60.0 / (tempo or choreography.tempo)
        self._begun = self._phase_begun = stamp
        self._phase = DancePhase.PREPARING
        self._body = body
        self._from = standing_posture(body)
        self._now = (self._from, 0.0)  # the posture sent last: positions, squat
        self._beat = 0
        self._waiting: tuple[
            tuple[float, float, float], ...
        ] = ()  # steps that begin when the earlier ones are done
        self._last_index = -1  # of the last step sent
        self._first_index: int | None = None
        self._cancelled = False
        self._worst = 0.0
        self._progress = 0.0

    def cancel(self) -> None:
        """End the dance: return to standing from the present posture."""
        self._cancelled = True

    def update(self, stamp: int, joints: JointStates, gait: GaitState) -> DanceTick:
        """Take the newest joint states and gait state; returns what to send."""
        if self._first_index is None:
            self._first_index = gait.footstep_index
        error = float(np.linalg.norm(joints.position[UPPER_BODY] - self._now[0])) / math.sqrt(self._from.size)
        self._worst = max(self._worst, error)
        plan = None
        result = None
        if gait.mode in _BROKEN:
            result = self._result(stamp, gait, f"{gait.mode.name.lower().replace('_', ' ')}: {gait.reason}")
        elif self._cancelled and self._phase is not DancePhase.RETURNING:
            self._enter(DancePhase.RETURNING, stamp)
        elapsed = (stamp - self._phase_begun) / SECOND
        if self._phase is DancePhase.PREPARING:
            self._move(self._from, self._beats[-1], elapsed / _PREPARE)
            if elapsed >= _PREPARE:
                self._enter(DancePhase.DANCING, stamp)
        elif self._phase is DancePhase.DANCING:
            plan = self._dance(stamp, elapsed, gait)
        elif self._phase is DancePhase.RETURNING:
            self._move(self._from, Beat(), min(elapsed / _PREPARE, 1.0))
            if elapsed >= _PREPARE and not self._stepping(gait):
                result = result or self._result(stamp, gait, "canceled" if self._cancelled else "")
        feedback = DanceFeedback(self._beat, self._phase, self._progress, error)
        posture = None if result else Posture(self._now[0].copy(), self._now[1])
        return DanceTick(posture, plan, feedback, result)

    def stopped(self, gait: GaitState, why: str) -> DanceResult:
        """The result if something else ends the dance; `gait` is the last state of the controller."""
        return self._result(gait.stamp, gait, why)

    def _dance(self, stamp: int, elapsed: float, gait: GaitState) -> FootstepPlan | None:
        """One tick of dancing; returns the steps of a beat when it begins."""
        number = int(elapsed / self._period)
        if number >= self._count:
            self._enter(DancePhase.RETURNING, stamp)
            self._progress = 1.0
            return None
        before, beat = self._beats[(number - 1) % len(self._beats)], self._beats[number % len(self._beats)]
        self._move(before.joints(self._body), beat, elapsed / self._period - number, before.squat)
        self._progress = max(self._progress, elapsed / (self._period * self._count))
        if number + 1 != self._beat:
            self._beat = number + 1
            self._waiting = beat.steps or self._waiting
        if not self._waiting or self._stepping(gait):
            return None
        motions, self._waiting = self._waiting, ()
        return self._walk(motions, gait)

    def _walk(self, motions: tuple[tuple[float, float, float], ...], gait: GaitState) -> FootstepPlan:
        """The steps for motions of the body from where it stands; the last one joins the feet."""
        base, leg, steps = gait.stance.centre, Leg.RIGHT, list[Footstep]()
        for motion in motions:
            base = advance(base, leg, motion, self._limits)
            steps.append(footstep(gait.footstep_index + len(steps), leg, base, self._limits))
            leg = leg.other
        steps.append(footstep(gait.footstep_index + len(steps), leg, base, self._limits))
        self._last_index = steps[-1].index
        return FootstepPlan(0, tuple(steps), (float(base[0]), float(base[1]), float(base[2])))

    def _move(self, start: Array, beat: Beat, share: float, squat: float = 0.0) -> None:
        share = min(max(share, 0.0), 1.0)
        self._now = (blend(start, beat.joints(self._body), share), squat + (beat.squat - squat) * share)

    def _enter(self, phase: DancePhase, stamp: int) -> None:
        self._phase, self._phase_begun, self._from = phase, stamp, self._now[0]

    def _result(self, stamp: int, gait: GaitState, message: str) -> DanceResult:
        steps = gait.footstep_index - (self._first_index or 0)
        seconds = (stamp - self._begun) / SECOND
        return DanceResult(not message, message, steps, self._beat, seconds, self._worst)

    def _stepping(self, gait: GaitState) -> bool:
        """Whether a foot still has to move."""
        return gait.footstep_index <= self._last_index or gait.stance.support is not Support.BOTH
