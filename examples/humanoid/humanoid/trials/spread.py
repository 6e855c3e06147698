"""All nodes in lockstep, in one process or in four: the same run, with the same state hash.

Time is virtual, and the simulator keeps pace with it. Callbacks that wait, as the simulator's do, hold up all
nodes of their executor, so each group of nodes has an executor and a thread of its own, wherever it is.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable, Sequence
from functools import partial
from typing import Any, NamedTuple

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rmw_local import lockstep

from ..show import crew
from ..show.director import Score
from . import graph_trials
from .graph import Played, make_simulator, perform, spun
from .user import ScenarioError, User

Group = tuple[str, ...]
"""Names of nodes."""

_CONTROL = ("imu_fusion", "whole_body_controller")
GROUPS: dict[str, Group] = {
    "physics": crew.GROUPS["physics"],
    "control": _CONTROL,
    "planning": tuple(
        name
        for group in ("motion", "limbs", "tasks")
        for name in crew.members(group, with_extra=False)
        if name not in _CONTROL
    ),
    "user": (),
}
"""Those that have a process each. The user is in the last one."""


class Trial(NamedTuple):
    """The outcome of a trial: how it was played, or why it could not be, and the score."""

    played: Played[Any] | None
    problem: str
    score: Score


def play(trial: str, arguments: Sequence[Any] = (), *, processes: int, seed: int = 0) -> Trial:
    """Play a function of `graph_trials`, with all nodes in one process or in four. Raises LockstepError."""
    if processes not in (1, len(GROUPS)):
        raise ValueError(f"the nodes can be in 1 process or in {len(GROUPS)}, not in {processes}")
    groups = list(GROUPS.values())
    *others, last = [groups] if processes == 1 else [[group] for group in groups]
    found: Trial = lockstep.run(
        *(partial(_serve, each, seed) for each in others),
        partial(_direct, last, seed, trial, arguments),
        names=list(GROUPS)[-processes:],
    )
    return found


def _serve(groups: Iterable[Group], seed: int) -> None:
    """Run groups of nodes until Ctrl-C."""
    _start(groups, seed)
    threading.Event().wait()


def _direct(groups: Iterable[Group], seed: int, trial: str, arguments: Sequence[Any]) -> Trial:
    """Run groups of nodes beside the user, until the trial is over."""
    _start(groups, seed)
    user = User(lambda what: None)
    executor = _executor([user])
    task = executor.create_task(perform, user, partial(_begin, trial, arguments))
    try:
        return Trial(spun(executor, task), "", user.score)
    except ScenarioError as error:
        return Trial(None, str(error), user.score)


def _begin(trial: str, arguments: Sequence[Any], user: User) -> Any:
    return getattr(graph_trials, trial)(user, *arguments)


def _start(groups: Iterable[Group], seed: int) -> None:
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    for group in groups:
        is_physics = group == GROUPS["physics"]
        nodes = [make_simulator(seed=seed, speed=1.0)] if is_physics else crew.make(group, {})
        threading.Thread(target=_executor(nodes).spin, daemon=True).start()


def _executor(nodes: Iterable[Node]) -> SingleThreadedExecutor:
    executor = SingleThreadedExecutor()
    for node in nodes:
        executor.add_node(node)
    return executor
