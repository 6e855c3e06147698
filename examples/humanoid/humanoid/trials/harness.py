"""The nodes' classes in one loop, in lockstep, without messages between them: for tests and benchmarks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..control.controller import WholeBodyController
from ..control.posture import standing
from ..control.reference import GaitParameters
from ..control.standby import Standby
from ..data import GaitState, JointCommand, Mode, Odometry, Sensors
from ..planning.footsteps import PlanStatus, StepLimits, fitted, plan_footsteps
from ..planning.gait import GaitPlanner
from ..robot import model as models
from ..seeds import generator
from ..sensing.estimator import StateEstimator
from ..simulation.sim import QUIET, Noise, Simulator
from ..spatial import Array, wrap

FALLEN_HEIGHT = 0.45  # of our base_link, metres
_LEASE = 50_000_000  # ns


@dataclass(frozen=True, slots=True)
class Touchdown:
    """The landing of a foot and its planned place: planar poses in the world."""

    stamp: int
    side: int
    wanted: Array
    landed: Array

    @property
    def error(self) -> float:
        """Distance [m]."""
        return math.hypot(*(self.landed - self.wanted)[:2])

    @property
    def yaw_error(self) -> float:
        """Angle [rad]."""
        return abs(wrap(self.landed[2] - self.wanted[2]))


class Lockstep:
    """Simulator, estimator and controller, tick by tick."""

    def __init__(
        self,
        model: models.HumanoidModel | None = None,
        *,
        seed: int = 0,
        noise: Noise = QUIET,
        true_state: bool = False,
        parameters: GaitParameters | None = None,
        delay: Sequence[int] = (0,),
    ) -> None:
        """Set up; each command is late by one of the `delay`s [ticks], drawn at random."""
        self.model = model or models.load()
        self.simulator = Simulator(self.model, seed, noise)
        self.controller = WholeBodyController(self.model, parameters)
        self.estimator = StateEstimator(self.model)
        self.limits = fitted(StepLimits(), self.model.body)
        self.planner = GaitPlanner(self.limits)
        self.refused = ""  # why the controller refused the last plan
        self.true_state = true_state
        self.gait: GaitState | None = None
        self.odometry: Odometry | None = None
        self.standby = Standby(self.model)
        self._rescued = False  # by the servos, and the weight is not between the feet yet
        self.dead: set[str] = set()  # nodes that have died
        self.touchdowns: list[Touchdown] = []
        self._delay = np.array(delay)
        self._random = generator(seed, "delay")
        self._on_the_way: list[tuple[int, JointCommand]] = []  # commands, and when they arrive
        feet = self.controller.stepping.feet
        posture, base = standing(self.model, feet, self.controller.parameters)
        self.simulator.reset(posture, base)

    @property
    def time(self) -> float:
        """Simulated seconds."""
        return self.simulator.stamp * 1e-9

    @property
    def fell(self) -> bool:
        """Whether the robot has fallen, whatever its controller reports."""
        lies = self.simulator.data.qpos[2] < FALLEN_HEIGHT * self.model.body.scale
        return bool(lies) or self.controller.mode is Mode.FALLEN

    def tick(self) -> None:
        """Run one control period: sense, estimate, plan, control, step. Parts in `dead` do nothing."""
        now, sensors = self.simulator.stamp, self.simulator.sensors()
        if "state_estimator" not in self.dead:
            estimate = self.estimator.update(sensors.joints, sensors.imu, sensors.wrenches, self.gait)
            self.odometry = self.simulator.truth() if self.true_state else estimate
        if "gait_planner" not in self.dead:
            self._plan(now)
        if "whole_body_controller" not in self.dead:
            self._control(now, sensors)
        self._deliver(now)
        if (rescue := self.standby.tick(now, sensors)) is not None:
            self.simulator.protect(rescue)
        self.simulator.step()

    def _plan(self, now: int) -> None:
        """The gait planner's tick: it sends a sign of life, and what has changed."""
        self.controller.heard("gait_planner", now, _LEASE)
        if self.gait is not None and (plan := self.planner.update(self.gait)) is not None:
            self.refused = self.controller.follow(plan)

    def _control(self, now: int, sensors: Sensors) -> None:
        """The controller's tick, and the delivery of its command to the servos."""
        stepping = self.controller.stepping
        moving, before = stepping.sample.swing, stepping.taken
        wanted = stepping.landing.copy() if moving else None
        if self.standby.reason:
            self.controller.hold(self.standby.reason)
            self.controller.begin_here()
            self._rescued = True
        elif self._rescued and stepping.standing:
            self.controller.resume()
            self._rescued = False
        command = self.controller.tick(now, sensors.joints, sensors.imu, self.odometry)
        if stepping.taken > before and moving is not None and wanted is not None:
            landed = self.simulator.sole_truth().feet[moving.leg.side]
            self.touchdowns.append(Touchdown(now, moving.leg.side, wanted, landed))
        self.gait = self.controller.state()
        due = now + int(self._random.choice(self._delay)) * models.PERIOD
        # The next command does not overtake a late one.
        self._on_the_way.append((max([due, *(late for late, _ in self._on_the_way)]), command))

    def _deliver(self, now: int) -> None:
        """Pass the commands that have arrived to the servos."""
        while self._on_the_way and self._on_the_way[0][0] <= now:
            _, command = self._on_the_way.pop(0)
            if self.simulator.apply(command):
                self.standby.commanded(now, command.position)

    def run(self, seconds: float) -> None:
        """Tick for a time, or until the robot falls."""
        end = self.simulator.stamp + round(seconds * 1e9)
        while self.simulator.stamp < end and not self.fell:
            self.tick()

    def go_to(self, goal: tuple[float, float, float], limit: float = 60.0) -> float:
        """Plan to a goal from the estimated stance, and walk; returns the distance left."""
        stance = self.controller.state().stance
        index = self.controller.stepping.index
        result = plan_footsteps(stance, goal, limits=self.limits, first_index=index)
        if result.status is not PlanStatus.PLANNED:
            raise ValueError(result.message)
        self.planner.walk(result.plan)
        self.settle(limit)
        return self.distance_to(goal)

    def distance_to(self, goal: tuple[float, float, float]) -> float:
        """True distance of base_footprint from a goal [m]."""
        centre = self.simulator.sole_truth().centre
        return math.hypot(centre[0] - goal[0], centre[1] - goal[1])

    def settle(self, limit: float) -> None:
        """Tick until the robot stands, at most `limit` seconds."""
        end = self.simulator.stamp + round(limit * 1e9)
        self.run(0.02)
        while self.simulator.stamp < end and not self.fell and not self.controller.stepping.standing:
            self.tick()

    def foot_error(self) -> tuple[float, float]:
        """Root mean square and maximum of the errors of all landings [m]."""
        errors = [touchdown.error for touchdown in self.touchdowns]
        return math.sqrt(float(np.mean(np.square(errors)))), max(errors)
