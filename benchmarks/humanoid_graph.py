"""The humanoid over the node graph: targets and measurements, and the cost of the nodes.

python benchmarks/humanoid_graph.py [--quick]     fewer goals, poses and pushes

All nodes of `ifgen demo` in one process on the local transport, in lockstep, with noisy sensors; everything
is requested and measured through messages. In the last rows the nodes are in processes that share virtual
time. "True state" is the same without noise, and with the controller's /odom remapped to the simulator's
ground truth. Errors are true errors; times are simulated unless they say CPU.
"""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from _table import Row, is_quick, show

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "examples/humanoid"))

import ifgen

ifgen.activate("local")

# ruff: noqa: E402  # importable only from here on
from _graph_costs import show_costs
from humanoid.planning.choreography import DANCES
from humanoid.show.director import Score
from humanoid.trials import graph_trials as trials
from humanoid.trials import spread
from humanoid.trials.graph import NodeGraph
from humanoid.trials.user import ScenarioError, User

GOAL = (1.0, 0.5, math.pi / 2)
TRUE_STATE = {"true_state": True, "noise": False}


def main() -> None:
    """Measure and print."""
    measures = (
        standing,
        walking,
        goal,
        cancelling,
        pushes,
        dancing,
        goals,
        kinematics,
        repeating,
        speed,
        spreading,
    )
    quick = is_quick(__doc__)
    show(measures, quick)
    show_costs(1 if quick else 5)


@dataclass(slots=True)
class Outcomes:
    """The outcomes of several trials, each in a graph of its own."""

    falls: int = 0
    problems: list[str] = field(default_factory=list)
    scores: list[Score] = field(default_factory=list)
    results: list[Any] = field(default_factory=list)

    def play(self, trial: Callable[[User], Awaitable[Any]], **options: Any) -> None:
        """One more trial."""
        with NodeGraph(**options) as graph:
            try:
                self.results.append(graph.play(trial).result)
            except ScenarioError as error:
                self.problems.append(str(error))
            self.scores.append(graph.user.score)
        self.falls += bool(graph.user.score.falls)

    def __str__(self) -> str:
        others = [problem for problem in self.problems if "fallen" not in problem]
        ended = f", {len(others)} ended early: {others[0]}" if others else ""
        return f"{self.falls} falls of {len(self.scores)}{ended}"


def standing(quick: bool) -> list[Row]:
    """The drift of the body."""
    outcomes, seconds = Outcomes(), 10.0 if quick else 60.0
    outcomes.play(lambda user: trials.stand(user, seconds), seed=1)
    moved = max(outcomes.results, default=math.nan)
    return [(f"stands {seconds:.0f} s", "no fall", f"{outcomes}, moved {moved * 1e3:.1f} mm at most")]


def walking(quick: bool) -> list[Row]:
    """Twelve steps straight ahead."""
    rows = []
    for name, asked, options, seeds in (
        ("true state", "<= 10 mm rms", TRUE_STATE, 1),
        ("sensors", "<= 10 mm rms", {}, 2 if quick else 6),
    ):
        outcomes = Outcomes()
        for seed in range(seeds):
            outcomes.play(trials.walk_straight, seed=seed, **options)
        rms = max(score.foot_error for score in outcomes.scores) * 1e3
        most = max(max(score.foot_errors, default=math.nan) for score in outcomes.scores) * 1e3
        found = f"{outcomes}, {rms:.1f} mm rms, {most:.1f} mm at most"
        rows.append((f"12 steps at 0.5 m/s, {name}", f"no fall, {asked}", found))
    return rows


def goal(quick: bool) -> list[Row]:
    """A walk to the goal of the requirements, through the action."""
    rows = []
    for name, options in (("true state", TRUE_STATE), ("sensors", {})):
        outcomes = Outcomes()
        for seed in range(1 if options else 3):
            outcomes.play(lambda user: trials.walk_to(user, GOAL, 0.0, 0), seed=seed, **options)
        errors = [error for score in outcomes.scores for error in score.goal_errors]
        found = f"{outcomes}, {1e3 * max(errors, default=math.nan):.1f} mm at most"
        rows.append((f"goal (1, 0.5, 90 degrees), {name}", "<= 30 mm", found))
    return rows


def cancelling(quick: bool) -> list[Row]:
    """The time that stopping takes."""
    random, outcomes = np.random.default_rng(0), Outcomes()
    for seed in range(5 if quick else 30):
        x, y, yaw = random.uniform((-2, -2, -3), (2, 2, 3))
        after = random.uniform(0.1, 7.0)
        outcomes.play(partial(trials.cancel_walk, goal=(x, y, yaw), after=after), seed=seed)
    times = [stop for score in outcomes.scores for stop in score.stop_times] or [math.nan]
    found = f"{outcomes}, {np.mean(times):.2f} s mean, {max(times):.2f} s at most"
    return [("cancel at a random moment of a walk, until it stands", "<= 2.5 s", found)]


def pushes(quick: bool) -> list[Row]:
    """Pushes from all directions."""
    directions = range(0, 360, 90 if quick else 45)
    standing, walking = Outcomes(), Outcomes()
    for degrees in directions:
        standing.play(partial(trials.push_standing, momentum=4.0, degrees=degrees), seed=degrees)
        for after in (2.9, 3.3):
            walking.play(
                partial(trials.push_walking, momentum=3.0, degrees=degrees, after=after), seed=degrees
            )
    return [
        (f"pushed with 4 N s standing, {len(directions)} directions", "no fall", str(standing)),
        (f"pushed with 3 N s walking, {len(directions)} directions, two phases", "no fall", str(walking)),
    ]


def dancing(quick: bool) -> list[Row]:
    """Every dance from beginning to end."""
    rows = []
    for name in ("wave",) if quick else sorted(DANCES):
        outcomes = Outcomes()
        outcomes.play(partial(trials.dance, name=name), seed=6)
        (score,) = outcomes.scores
        rows.append((f"dance '{name}'", "a whole dance", f"{outcomes}, {score.dances} whole"))
    return rows


def goals(quick: bool) -> list[Row]:
    """Random goals with noise and pushes, through the action."""
    random, outcomes = np.random.default_rng(11), Outcomes()
    for seed in range(3 if quick else 20):
        x, y, yaw = random.uniform((-2, -2, -math.pi), (2, 2, math.pi))
        outcomes.play(partial(trials.walk_to, goal=(x, y, yaw), momentum=3.0, seed=seed), seed=seed)
    errors = [error for score in outcomes.scores for error in score.goal_errors] or [math.nan]
    steps = sum(score.steps for score in outcomes.scores)
    found = (
        f"{outcomes}, {sum(outcomes.results)} reached, {steps} steps, "
        f"{1e3 * np.median(errors):.0f} mm median, {1e3 * max(errors):.0f} mm at most"
    )
    return [(f"random goals, pushed by 3 N s every {trials.BETWEEN_PUSHES:g} s", "no fall", found)]


def kinematics(quick: bool) -> list[Row]:
    """Poses, requested from the services."""
    count, others, outcomes = 100 if quick else 1000, 20 if quick else 200, Outcomes()
    outcomes.play(partial(trials.kinematics, count=count, others=others))
    (found,) = outcomes.results
    return [
        (
            f"services, {chain}: {count} reachable poses, {others} others",
            f">= 99 %, 0 of {others}",
            f"{100 * solved / count:.1f} %, {claimed} of {others}",
        )
        for chain, (solved, claimed) in found.items()
    ]


def repeating(quick: bool) -> list[Row]:
    """The hash over all states of a walk with a push and a cancel."""

    def run(seed: int) -> str:
        with NodeGraph(seed=seed) as graph:
            return graph.play(trials.disturbed).state_hash

    same, other = run(1) == run(1), run(1) == run(2)
    return [("state hash of two runs; of another seed", "equal; not", f"{same}; {other}")]


def speed(quick: bool) -> list[Row]:
    """The real-time factor of twelve steps with all nodes in this process."""
    real, cpu = [], []
    for seed in range(1 if quick else 3):
        with NodeGraph(seed=seed) as graph:
            played = graph.play(trials.walk_straight)
        real.append(played.simulated / played.real)
        cpu.append(played.simulated / played.cpu)
    found = f"{np.median(real):.1f} x real time on the wall, {np.median(cpu):.1f} x in CPU time"
    return [("12 steps, all nodes in one process", ">= 1 x", found)]


def spreading(quick: bool) -> list[Row]:
    """The same in lockstep, in one process and in four, by turns."""
    factors: dict[int, list[float]] = {1: [], 4: []}
    hashes: set[tuple[int, str]] = set()
    seeds = range(1 if quick else 3)
    for seed in seeds:
        for processes, found in factors.items():
            played = spread.play("walk_straight", processes=processes, seed=seed).played
            assert played is not None
            found.append(played.simulated / played.real)
            hashes.add((seed, played.state_hash))
    load = f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores"
    rows = [
        (f"12 steps in lockstep, {name}", asked, f"{np.median(factors[count]):.1f} x real time ({load})")
        for count, name, asked in ((1, "one process", ""), (4, "four processes", ">= 1 x"))
    ]
    same = len(hashes) == len(seeds)
    return [*rows, ("state hash in four processes and in one", "equal", "equal" if same else "different")]


if __name__ == "__main__":
    main()
