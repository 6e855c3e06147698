"""The CPU time of a walk over the node graph: by kind of work, and node by node.

Import it after rclpy's transport is chosen.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Container
from functools import cache
from types import FrameType
from typing import Any
from unittest.mock import patch

import numpy as np
from _sampler import Samples, sampled
from humanoid.simulation.sim import Noise
from humanoid.trials import graph_trials as trials
from humanoid.trials.graph import NodeGraph
from humanoid.trials.harness import Lockstep
from humanoid.trials.user import User
from rclpy._executor.callback_runner import CallbackRunner

PHYSICS, CODEC, TRANSPORT = "physics", "messages to bytes and back", "transport and executor"
DIRECTOR = "who asks and measures"

# The robot's own work, and the cost of doing it in nodes. A sample of the stack counts for the innermost file
# that is in one of these tables; shared helpers and numpy do not count.
ROBOT = {
    PHYSICS: (),  # one function of sim.py
    "sensors, ground truth, set-points": ("/humanoid/simulation/sim.py",),
    "estimator": ("/humanoid/sensing/estimator.py",),
    "controller": ("/humanoid/control/controller.py",),
    "planner, navigation": (
        "/humanoid/planning/gait.py",
        "/humanoid/planning/footsteps.py",
        "/humanoid/planning/navigation.py",
    ),
    "checks of readings": ("/humanoid/control/plausible.py", "/humanoid/control/inputs.py"),
    "battery, standby, diagnostics": (
        "/humanoid/simulation/battery.py",
        "/humanoid/control/standby.py",
        "/humanoid/sensing/joints.py",
        "/humanoid/simulation/safety.py",
        "/humanoid/ros/diagnostics.py",
    ),
}
GRAPH = {
    "data to messages and back": ("/humanoid/ros/messages.py",),
    CODEC: ("/ifgen_runtime/",),  # and functions of the generated packages
    "callbacks of nodes": ("/generated/",),
    TRANSPORT: ("/rclpy/", "/rmw_local/"),
}
LOOP = "/humanoid/trials/graph.py"  # around all others, so it counts only where it is the innermost
MEASURING = ("/humanoid/show/director.py", "/humanoid/trials/graph_trials.py")

Look = tuple[str, str]
"""A kind of work and a node; the node is empty between callbacks."""


def show_costs(walks: int) -> None:
    """Walk twelve steps several times, and print two tables."""
    simulated, samples, loops = 0.0, Samples(), []
    for seed in range(walks):
        with NodeGraph(seed=seed) as graph, sampled(look_at) as found:
            graph.play(trials.walk_straight)
            simulated += graph.user.now
        samples.counts += found.counts
        samples.cpu += found.cpu
        loops.append(_loop(seed))

    def cost(kinds: Container[str], node: str | None = None) -> float:
        """CPU [ms] per simulated second."""
        chosen = samples.seconds(lambda look: look[0] in kinds and node in {None, look[1]})
        return 1e3 * chosen / simulated

    whole = 1e3 * samples.cpu / simulated
    looks = samples.counts.total()
    print(f"\nCPU of a simulated second of standing and walking, from {looks} looks at the stack:")
    print("\n| what | ms | share |\n|---|---:|---:|")
    for name, kinds in (
        *((name, (name,)) for name in ROBOT),
        ("**the robot's own work**", ROBOT),
        *((name, (name,)) for name in GRAPH),
        ("**the node graph**", GRAPH),
        (DIRECTOR, (DIRECTOR,)),
        ("**all**", (*ROBOT, *GRAPH, DIRECTOR)),
    ):
        print(f"| {name} | {cost(kinds):.1f} | {100 * cost(kinds) / whole:.0f} % |")
    print(f"\nThe same as one loop without messages, measured in between: {np.median(loops):.1f} ms.\n")
    print("| node | callbacks of a simulated second | its own work [ms] | the node graph [ms] |")
    print("|---|---:|---:|---:|")
    for name, count in _callbacks().items():
        print(f"| {name} | {count:.0f} | {cost(ROBOT, name):.1f} | {cost(GRAPH, name):.1f} |")
    print(f"| the executor, between callbacks | | | {cost(GRAPH, ''):.1f} |")


def look_at(frame: FrameType) -> Look:
    """The kind of work that a stack shows."""
    if frame.f_code.co_filename.endswith(LOOP):
        return DIRECTOR, ""
    kind = node = ""
    outer: FrameType | None = frame
    while outer is not None and not node:
        code = outer.f_code
        if code.co_filename.endswith(MEASURING):
            return DIRECTOR, ""
        kind = kind or _kind(code.co_filename, code.co_name)
        if code.co_name == "run" and "watch" in outer.f_locals:
            node = outer.f_locals["watch"].node.get_name()
        outer = outer.f_back
    return (DIRECTOR, "") if node == "director" else (kind or TRANSPORT, node)


@cache
def _kind(path: str, function: str) -> str:
    if function == "step" and path.endswith("/humanoid/simulation/sim.py"):
        return PHYSICS
    if function.startswith(("_serialize", "_deserialize")):
        return CODEC
    return next(
        (kind for kind, files in (*ROBOT.items(), *GRAPH.items()) if any(file in path for file in files)), ""
    )


def _loop(seed: int) -> float:
    """CPU [ms] per simulated second if the nodes' classes call each other."""
    robot = Lockstep(seed=seed, noise=Noise())
    cpu = time.process_time()
    robot.run(1.0)
    robot.planner.walk(trials.STRAIGHT)
    robot.settle(20.0)
    return 1e3 * (time.process_time() - cpu) / robot.time


def _callbacks() -> dict[str, float]:
    """The number of calls of each node per simulated second of the walk, most frequent first."""
    calls: Counter[str] = Counter()
    run = CallbackRunner.run

    def counted(runner: CallbackRunner, watch: Any, executor: Any) -> None:
        calls[watch.node.get_name()] += 1
        run(runner, watch, executor)

    async def walk(user: User) -> None:
        calls.clear()
        await trials.walk_straight(user)

    with patch.object(CallbackRunner, "run", counted), NodeGraph(seed=0) as graph:
        seconds = graph.play(walk).simulated
    return {name: count / seconds for name, count in calls.most_common() if name != "director"}
