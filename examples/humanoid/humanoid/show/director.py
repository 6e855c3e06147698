"""A node that watches a scenario and keeps score. It asks nothing of the robot."""

from __future__ import annotations

import contextlib
import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import WrenchStamped
from humanoid_interfaces.msg import EmergencyStop, FootstepPlan, GaitState, ObstacleTouch, Stance, TaskStatus
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import serialize_message
from visualization_msgs.msg import MarkerArray

from ..data import SECOND, Footstep, Mode
from ..planning.tasks import task_of
from ..robot.obstacles import Solid
from ..ros import messages
from ..ros.diagnostics import UNANSWERED
from ..ros.markers import read_obstacle_markers
from ..spatial import Array
from .audience import PUSH_TIME

_LATEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
_LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_TASKS = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_ASTRAY = 0.08  # m from its goal at which a walk has failed, whatever the robot believes
_LYING = 0.62  # share of the greatest height of base_link below which the robot lies
_LOOK = 0.1  # s of simulated time between checks that everything is over
_LAST = 1.0  # s of simulated time from then until the end

Say = Callable[[str], None]


@dataclass(slots=True)
class Score:
    """The results as messages report them; lengths in metres, times in simulated seconds."""

    steps: int = 0
    distance: float = 0.0  # of the middle between the soles, from step to step
    walking: float = 0.0  # in mode WALKING
    falls: int = 0
    foot_errors: list[float] = field(default_factory=list)
    goal_errors: list[float] = field(default_factory=list)
    dances: int = 0
    pushes: int = 0
    obstacles: int = 0  # in the scene
    touches: int = 0  # of obstacles by links of the robot
    stop_times: list[float] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)  # tasks that failed though nobody stopped the robot

    @property
    def speed(self) -> float:
        """The mean speed of walks [m/s]."""
        return self.distance / self.walking if self.walking else 0.0

    @property
    def foot_error(self) -> float:
        """Root mean square of the distances between the feet's landings and their planned places."""
        errors = self.foot_errors
        return math.sqrt(sum(e * e for e in errors) / len(errors)) if errors else 0.0

    def arrive(self, words: str, error: float) -> None:
        """Note where a walk really ended, by its distance from the goal [m]: one far from it has failed."""
        self.goal_errors.append(error)
        if error > _ASTRAY:
            where = f"it ended {error * 1e3:.0f} mm from its goal, more than {_ASTRAY * 1e3:.0f}"
            self.failures.append(f"{words}: {where}")


class Director(Node):
    """Keeps score; `say` is called with what happens, `is_quiet` tells whether nobody else has plans."""

    def __init__(self, say: Say, is_quiet: Callable[[], bool] = lambda: True) -> None:
        super().__init__("director", parameter_overrides=[Parameter("use_sim_time", value=True)])
        self.score = Score()
        self.mode = Mode.UNKNOWN
        self.fallen = False  # according to the controller, or to where it really is
        self.begun: float | None = None  # when the first task began, simulated seconds
        self.is_over = False
        self._say = say
        self._is_quiet = is_quiet
        self._task = TaskStatus()
        self._task_begun = 0.0
        self._is_stopped = False
        self._planned: dict[int, Footstep] = {}
        self._solids: dict[str, Solid] = {}
        self._truth: tuple[Array, Array] | None = None
        self._middle: Array | None = None  # between the soles, at the last landing
        self._base: Array | None = None
        self._height = 0.0  # the greatest of base_link [m]
        self._index: int | None = None
        self._end = math.inf
        self._digest = hashlib.sha256()
        self._unanswered = 0  # steps of the simulator
        self._seen_at: int | None = None  # stamp of the last gait state
        self._true_at = 0  # stamp of the last true pose
        topics: tuple[tuple[type[Any], str, QoSProfile | int, Callable[[Any], None]], ...] = (
            (TaskStatus, "/high_level_task_manager/task", _TASKS, self._on_task),
            (GaitState, "/gait_state", _LATCHED, self._on_gait),
            (FootstepPlan, "/footsteps/upcoming", _LATCHED, self._on_plan),
            (EmergencyStop, "/emergency_stop", _LATCHED, self._on_stop),
            (WrenchStamped, "/humanoid_simulator/push", 10, self._on_push),
            (DiagnosticArray, "/diagnostics", 10, self._on_diagnostics),
            (MarkerArray, "/humanoid_simulator/obstacles", _LATCHED, self._on_obstacles),
            (ObstacleTouch, "/humanoid_simulator/touches", 10, self._on_touch),
            (Stance, "/humanoid_simulator/ground_truth/stance", _LATEST, self._on_truth),
            (Odometry, "/humanoid_simulator/ground_truth/odom", _LATEST, self._on_odometry),
        )
        for kind, topic, qos, heard in topics:
            self.create_subscription(kind, topic, heard, qos)
        self.create_timer(_LOOK, self._look)

    @property
    def state_hash(self) -> str:
        """SHA-256 over the true poses of the robot at every moment: equal runs have equal hashes."""
        return self._digest.hexdigest()

    @property
    def repeats(self) -> bool:
        """Whether another run with the same seed is the same: time has always waited for set-points."""
        return not self._unanswered

    @property
    def now(self) -> float:
        """Simulated seconds."""
        return float(self.get_clock().now().nanoseconds) / SECOND

    @property
    def base(self) -> Array | None:
        """The true position (3,) of base_link [m], if the simulator publishes it."""
        return self._base

    def distance_to(self, x: float, y: float) -> float:
        """True distance of the middle between the soles from a point [m]; infinite if not published."""
        middle = self._middle_now()
        return math.inf if middle is None else math.hypot(middle[0] - x, middle[1] - y)

    def _begin_anew(self) -> None:
        """Forget the run before: the simulator has started again."""
        self.score = Score(obstacles=self.score.obstacles)
        self.begun, self._end = None, math.inf
        self._planned.clear()
        self._middle = self._index = self._seen_at = self._base = None
        self._height = 0.0
        self._digest = hashlib.sha256()
        self._say("time starts again")

    def _look(self) -> None:
        """Note the end: the last task is done, and nobody has plans. A robot that lies has no future."""
        is_idle = self._task.state == TaskStatus.STATE_IDLE and self._task.number > 0
        if not (self.fallen or (is_idle and self._is_quiet())):
            self._end = math.inf
        elif self._end == math.inf:
            self._end = self.now + _LAST
        self.is_over = self.now >= self._end

    def _on_task(self, message: TaskStatus) -> None:
        self._task = message
        match message.state:
            case TaskStatus.STATE_RUNNING:
                self._begin(message)
            case TaskStatus.STATE_SUCCEEDED:
                self._succeed(message)
            case TaskStatus.STATE_CANCELED:
                self._cancelled(message)
            case TaskStatus.STATE_FAILED:
                self._say(f"not done: {message.message}")
                if not self._is_stopped:
                    self.score.failures.append(f"{message.words}: {message.message}")

    def _begin(self, message: TaskStatus) -> None:
        self._task_begun = self.now
        if self.begun is None:
            self.begun = self.now
        kind = message.words.partition(" ")[0]
        if kind == "walk":
            x, y, yaw = messages.planar(message.goal)
            self._say(f"walk to ({x:g} m, {y:g} m, {math.degrees(yaw):.0f} deg)")
        elif kind != "wait":
            self._say(message.words)

    def _succeed(self, message: TaskStatus) -> None:
        kind = message.words.partition(" ")[0]
        if kind == "walk":
            x, y, _ = messages.planar(message.goal)
            error = self.distance_to(float(x), float(y))
            if math.isfinite(error):
                self.score.arrive(message.words, error)
            self._say(f"arrived with {message.message}, {error * 1e3:.0f} mm off")
        elif kind == "dance":
            self.score.dances += 1
            self._say(f"danced {message.message}")

    def _cancelled(self, message: TaskStatus) -> None:
        asked = task_of(message.words).seconds
        if message.words.startswith("walk") and asked:
            self.score.stop_times.append(self.now - self._task_begun - asked)
            self._say(f"cancelled: stands after {self.score.stop_times[-1]:.2f} s")
        else:
            self._say(f"cancelled: {message.words}")

    def _on_push(self, message: WrenchStamped) -> None:
        x, y, _ = messages.numbers(message.wrench.force) * PUSH_TIME
        self.score.pushes += 1
        degrees = math.degrees(math.atan2(y, x)) % 360
        self._say(f"pushed with {math.hypot(x, y):g} N s towards {degrees:.0f} deg")

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for value in (value for status in message.status for value in status.values):
            if value.key == UNANSWERED and value.value.isdecimal():
                self._unanswered = int(value.value)

    def _on_obstacles(self, message: MarkerArray) -> None:
        solids = {solid.name: solid for solid in read_obstacle_markers(message)}
        for name, solid in solids.items():
            if name in self._solids and solid != self._solids[name]:
                self._say(f"{name} is moved to ({solid.x:g} m, {solid.y:g} m)")
        self._solids, self.score.obstacles = solids, len(solids)

    def _on_touch(self, message: ObstacleTouch) -> None:
        self.score.touches += 1
        self._say(f"touches {message.obstacle} with {message.link}")

    def _on_stop(self, message: EmergencyStop) -> None:
        if message.active != self._is_stopped:
            self._say("emergency stop" if message.active else "released: the robot accepts goals again")
        self._is_stopped = message.active

    def _on_gait(self, message: GaitState) -> None:
        try:
            state = messages.read_gait_state(message)
        except ValueError:
            return  # whoever acts on it says so
        if self.mode is Mode.WALKING and self._seen_at is not None:
            self.score.walking += max(state.stamp - self._seen_at, 0) / SECOND
        self.mode, self._seen_at = state.mode, state.stamp
        fallen = self.mode is Mode.FALLEN or self._lies()
        if fallen and not self.fallen:
            self.score.falls += 1
            self._say("fallen: /humanoid_simulator/reset, or Restart on the page, stands it up")
        before, self._index = self._index, state.footstep_index
        self.fallen = fallen
        if before is not None and self._index == before + 1:
            self._landed(before)

    def _landed(self, index: int) -> None:
        self.score.steps += 1
        middle = self._middle_now()
        if middle is None or self._truth is None:
            return
        if self._middle is not None:
            self.score.distance += math.dist(middle, self._middle)
        self._middle = middle
        step = self._planned.get(index)
        if step is not None:
            self.score.foot_errors.append(math.dist(step.pose[:2], self._truth[step.leg.side][:2]))

    def _middle_now(self) -> Array | None:
        return None if self._truth is None else (self._truth[0][:2] + self._truth[1][:2]) / 2

    def _lies(self) -> bool:
        return self._base is not None and bool(self._base[2] < _LYING * self._height)

    def _on_plan(self, message: FootstepPlan) -> None:
        with contextlib.suppress(ValueError):  # whoever would walk it says so
            self._planned.update((step.index, step) for step in messages.read_footstep_plan(message).steps)

    def _on_truth(self, message: Stance) -> None:
        try:
            self._truth = messages.read_stance(message).feet
        except ValueError:
            return
        if self._middle is None:
            self._middle = self._middle_now()

    def _on_odometry(self, message: Odometry) -> None:
        stamp = messages.nanoseconds(message.header.stamp)
        if stamp < self._true_at:
            self._begin_anew()
        self._true_at = stamp
        if stamp / SECOND <= self._end:
            self._digest.update(serialize_message(message))
        self._base = messages.numbers(message.pose.pose.position)
        self._height = max(self._height, float(self._base[2]))
