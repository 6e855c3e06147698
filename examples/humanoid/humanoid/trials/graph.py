"""All nodes in one process and one executor, in lockstep, with a user: for tests and benchmarks."""

from __future__ import annotations

import time
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from itertools import chain
from types import TracebackType
from typing import Any, Generic, TypeVar

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Task

from ..robot.obstacles import Solid, words_of
from ..show import crew
from ..show.director import Say
from .alone import alone
from .user import ScenarioError, User

Result = TypeVar("Result")

_LIMIT = 900.0  # s of real time for a scenario
_PATIENCE = 60.0  # s: if time went on because a machine is busy, the run would be a different one
# The controller receives the true pose; the estimator goes on estimating, but nobody listens.
_TRUE_STATE = ["--ros-args", "-r", "whole_body_controller:/odom:=/humanoid_simulator/ground_truth/odom"]


@dataclass(frozen=True, slots=True)
class Played(Generic[Result]):
    """The result of a scenario, and the time that it took [s]."""

    result: Result
    simulated: float
    real: float
    cpu: float
    state_hash: str


class NodeGraph:
    """The nodes of `crew.GROUPS`, connected only by messages; one graph at a time: it owns the context.

    Only a robot that `sees` has a camera, a map, and the detection of faces: drawing takes time. `solids` are
    obstacles.

    `true_state` lets the controller use ground truth as odometry.
    """

    def __init__(
        self,
        *,
        seed: int = 0,
        noise: bool = True,
        true_state: bool = False,
        say: Say = lambda what: None,
        solids: Sequence[Solid] = (),
        sees: bool = False,
    ) -> None:
        # Python handles Ctrl-C: it ends the scenario at once.
        with alone():
            rclpy.init(args=_TRUE_STATE if true_state else [], signal_handler_options=SignalHandlerOptions.NO)
        self.executor = SingleThreadedExecutor()
        self.user = User(say)
        _, *others = chain.from_iterable(crew.members(group, with_extra=sees) for group in crew.GROUPS)
        nodes = crew.make(others, {"camera_driver": {"streaming": sees}})
        # Made last, so that all nodes receive its first readings and need not wait until it repeats them.
        # An empty list has no type that a parameter could have.
        obstacles = {"obstacles": [words_of(solid) for solid in solids]} if solids else {}
        first = make_simulator(seed=seed, noise=noise, **obstacles)
        self.nodes = [first, *nodes, self.user]
        for node in self.nodes:
            self.executor.add_node(node)

    def __enter__(self) -> NodeGraph:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def play(self, scenario: Callable[[User], Awaitable[Result]]) -> Played[Result]:
        """Spin until a scenario is over. Raises ScenarioError if it cannot continue."""
        return spun(self.executor, self.executor.create_task(perform, self.user, scenario))

    def close(self) -> None:
        """End all nodes."""
        for node in self.nodes:
            node.destroy_node()
        self.executor.shutdown()
        rclpy.try_shutdown()


async def perform(user: User, scenario: Callable[[User], Awaitable[Result]]) -> Played[Result]:
    """Play a scenario as soon as the robot is ready."""
    await user.ready()
    # In lockstep, `time.monotonic` is virtual.
    begun, real, cpu = user.now, time.perf_counter(), time.process_time()
    result = await scenario(user)
    # Here, and not after the spin has ended, because time goes on until then.
    return Played(
        result,
        user.now - begun,
        time.perf_counter() - real,
        time.process_time() - cpu,
        user.state_hash,
    )


def spun(executor: SingleThreadedExecutor, task: Task[Played[Result]]) -> Played[Result]:
    """Spin until a task is done, and return its result. Raises ScenarioError if that takes too long."""
    end = time.perf_counter() + _LIMIT
    while not task.done():
        executor.spin_once()
        if time.perf_counter() > end:
            raise ScenarioError(f"not over after {_LIMIT:.0f} s")
    return task.result()


def make_simulator(**parameters: Any) -> Node:
    """The simulator in lockstep, with the truth as a topic."""
    values = {"lockstep": True, "patience": _PATIENCE, "ground_truth": True, **parameters}
    (node,) = crew.make(crew.GROUPS["physics"], {crew.SIMULATOR: values})
    return node
