"""The humanoid: targets and measurements.

python benchmarks/humanoid.py [--quick]     fewer goals, poses and pushes

Simulation in lockstep, without messages: simulator, estimator, gait planner and controller in one loop.
"Sensors" means joint states, IMU and foot wrenches with noise; "true state" means that the controller knows
where the robot is. Errors are true errors; times are simulated unless they say CPU.
"""

from __future__ import annotations

import math
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from _table import Row, is_quick, show

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # for the tests' bodies
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "examples/humanoid"))

from humanoid.data import Mode
from humanoid.kinematics import poses
from humanoid.kinematics.chains import CHAINS, ChainKinematics
from humanoid.kinematics.head import HeadMode, HeadPose
from humanoid.kinematics.ik import IkRequest, IkStatus, InverseKinematics
from humanoid.planning import dance
from humanoid.planning.choreography import DANCES
from humanoid.planning.footsteps import plan_footsteps
from humanoid.robot import model
from humanoid.robot.external import load_external
from humanoid.simulation.sim import QUIET, Noise, Simulator
from humanoid.trials import trials
from humanoid.trials.harness import Lockstep

from tests.humanoid.bodies import offset_hips, shorter_legs

MODEL = model.load()
NOISE = Noise()


def main() -> None:
    """Measure and print."""
    measures = (
        standing,
        walking,
        goal,
        goals,
        cancelling,
        pushes,
        dancing,
        dying,
        kinematics,
        head,
        repeating,
        speed,
        bodies,
    )
    show(measures, is_quick(__doc__))


def standing(quick: bool) -> list[Row]:
    """The drift of the body."""
    robot = Lockstep(MODEL, seed=1, noise=NOISE)
    robot.run(1.0)
    start, worst = robot.simulator.truth().position, 0.0
    while robot.time < (10.0 if quick else 60.0) and not robot.fell:
        robot.run(0.02)
        worst = max(worst, float(np.linalg.norm(robot.simulator.truth().position - start)))
    found = f"{'fell' if robot.fell else 'no fall'}, moved {worst * 1e3:.1f} mm at most"
    return [(f"stands {robot.time:.0f} s, sensors", "no fall", found)]


def walking(quick: bool) -> list[Row]:
    """Twelve steps straight ahead."""
    rows = []
    for name, asked, true_state, noise, seeds in (
        ("true state", "<= 10 mm rms", True, QUIET, 1),
        ("sensors", "<= 10 mm rms", False, NOISE, 2 if quick else 6),
    ):
        errors, falls = [], 0
        for seed in range(seeds):
            robot = Lockstep(MODEL, seed=seed, noise=noise, true_state=true_state)
            robot.run(0.5)
            robot.controller.follow(trials.STRAIGHT)
            robot.settle(20.0)
            falls += robot.fell
            errors.append(robot.foot_error())
        rms, most = (1e3 * max(error[i] for error in errors) for i in (0, 1))
        found = f"{falls} falls, {rms:.1f} mm rms, {most:.1f} mm at most"
        rows.append((f"12 steps at 0.5 m/s, {name}, worst of {seeds}", f"no fall, {asked}", found))
    return rows


def goal(quick: bool) -> list[Row]:
    """A walk to the goal of the requirements."""
    rows = []
    for name, true_state, noise in (("true state", True, QUIET), ("sensors", False, NOISE)):
        left = [
            Lockstep(MODEL, seed=seed, noise=noise, true_state=true_state).go_to((1.0, 0.5, math.pi / 2))
            for seed in range(1 if true_state else 3)
        ]
        rows.append((f"goal (1, 0.5, 90 degrees), {name}", "<= 30 mm", f"{max(left) * 1e3:.1f} mm"))
    return rows


def goals(quick: bool) -> list[Row]:
    """Random goals with pushes."""
    rows = []
    for momentum in (0.0, 3.0, 5.0):
        trial = trials.random_goals(MODEL, 5 if quick else 20, momentum, seed=11)
        errors = np.array(trial.errors) * 1e3
        found = (
            f"{trial.falls} falls, {trial.reached} reached, {trial.steps} steps, "
            f"{np.median(errors):.0f} mm median, {errors.max():.0f} mm at most"
        )
        pushed = f"pushed by {momentum:g} N s every {trials.BETWEEN_PUSHES:g} s"
        name = f"{len(errors)} random goals, sensors, {pushed}"
        rows.append((name, "no fall" if momentum <= 3 else "", found))
    return rows


def cancelling(quick: bool) -> list[Row]:
    """The time that stopping takes."""
    random = np.random.default_rng(0)
    times, falls = [], 0
    for seed in range(8 if quick else 30):
        robot = Lockstep(MODEL, seed=seed, noise=NOISE)
        robot.run(0.5)
        x, y, yaw = random.uniform((-2, -2, -3), (2, 2, 3))
        robot.planner.walk(plan_footsteps(robot.controller.state().stance, (x, y, yaw)).plan)
        robot.run(random.uniform(0.1, 7.0))
        began = robot.time
        robot.planner.cancel()
        robot.settle(10.0)
        falls += robot.fell or robot.controller.mode is not Mode.STANDING
        times.append(robot.time - began)
    found = f"{falls} falls, {np.mean(times):.2f} s mean, {max(times):.2f} s at most"
    return [(f"cancel at {len(times)} random moments, until it stands", "<= 2.5 s", found)]


def pushes(quick: bool) -> list[Row]:
    """The strongest push that the robot survives, by direction."""
    rows = []
    strengths = (4, 8, 12, 16, 20)
    for name, asked, walk in (("standing", "20 N s", False), ("walking, two phases", "3 N s", True)):
        survived = {}
        for direction in range(0, 360, 90 if quick else 45):
            limit = 0
            for momentum in (3, *strengths) if walk else strengths:
                if not all(
                    _survives(direction, momentum, phase) for phase in ((0.1, 0.5) if walk else (None,))
                ):
                    break
                limit = momentum
            survived[direction] = limit
        text = ", ".join(f"{direction}: {limit}" for direction, limit in survived.items())
        rows.append((f"push of 0.1 s on the torso, {name}; degrees: N s survived", f"{asked} anywhere", text))
    return rows


def _survives(direction: float, momentum: float, phase: float | None) -> bool:
    robot = Lockstep(MODEL, seed=1, noise=NOISE)
    robot.run(0.5)
    if phase is not None:
        robot.controller.follow(trials.STRAIGHT)
        robot.run(1.2 + 1.6 + phase)
    trials.push(robot, direction, momentum)
    robot.run(3.0)
    robot.settle(15.0)
    return not robot.fell


def dancing(quick: bool) -> list[Row]:
    """Every dance from beginning to end."""
    rows = []
    for name in ("disco",) if quick else sorted(DANCES):
        robot = Lockstep(MODEL, seed=6, noise=NOISE)
        robot.run(0.5)
        under_way = dance.Dance(name, 0.0, 0, robot.simulator.stamp)
        result = None
        while result is None and not robot.fell:
            robot.tick()
            assert robot.gait is not None
            tick = under_way.update(robot.simulator.stamp, robot.simulator.sensors().joints, robot.gait)
            robot.controller.posture(tick.posture)
            if tick.plan is not None:
                robot.planner.walk(tick.plan)
            result = tick.result
        done = (
            "fell" if result is None else f"{result.beats} beats, {result.steps} steps, {result.time:.1f} s"
        )
        worst = f", joints {result.joint_error:.3f} rad rms off at most" if result else ""
        rows.append((f"dance '{name}'", "a whole dance", done + worst))
    return rows


def dying(quick: bool) -> list[Row]:
    """The death of a node at a random moment of a walk."""
    rows = []
    soles = [MODEL.frames[f"{side}_sole"] for side in "lr"]
    for node in ("gait_planner", "state_estimator", "whole_body_controller"):
        random = np.random.default_rng(7)
        falls, times = 0, []
        for seed in range(5 if quick else 20):
            robot = Lockstep(MODEL, seed=seed, noise=NOISE)
            robot.run(0.5)
            robot.planner.walk(plan_footsteps(robot.controller.state().stance, (2.0, 0.6, 1.0)).plan)
            robot.run(random.uniform(1.2, 8.0))
            robot.dead.add(node)
            began = down = robot.time
            while robot.time < began + 3.0 and not robot.fell:
                robot.tick()
                if robot.simulator.data.site_xpos[soles, 2].max() > 0.008:
                    down = robot.time
            falls += robot.fell
            times.append(down - began)
        found = f"{falls} falls of {len(times)}, {np.median(times):.2f} s median, {max(times):.2f} s at most"
        rows.append((f"{node} dies in a walk, until both soles stay on the floor", "<= 1.5 s", found))
    return rows


def kinematics(quick: bool) -> list[Row]:
    """Reachable and unreachable poses of each chain."""
    solver = InverseKinematics(MODEL)
    count, rows = 100 if quick else 1000, []
    for name, chain in CHAINS.items():
        if name.startswith("right"):
            continue
        tip = ChainKinematics(MODEL, chain)
        random = np.random.default_rng(1)
        solved, times = 0, []
        for position, orientation in poses.reachable(tip, random, count):
            began = time.process_time()
            result = solver.solve(IkRequest(name, position, orientation, timeout=60.0))
            times.append(1e3 * (time.process_time() - began))
            solved += result.status is IkStatus.SOLVED
        claimed = sum(
            solver.solve(IkRequest(name, *pose)).status is IkStatus.SOLVED
            for pose in poses.beyond(tip, random, 200)
        )
        found = (
            f"{100 * solved / count:.1f} %, {claimed} of 200; CPU {np.mean(times):.2f} ms mean, "
            f"{np.median(times):.2f} median, {max(times):.0f} at most"
        )
        asked = ">= 99 %, 0 of 200"
        rows.append(
            (f"IK of {name}, {len(chain.joints)} joints: {count} reachable poses, 200 others", asked, found)
        )
    return rows


def head(quick: bool) -> list[Row]:
    """Head poses and points to look at."""
    checker, tip = HeadPose(MODEL), ChainKinematics(MODEL, CHAINS["head"])
    random, count = np.random.default_rng(2), 100 if quick else 1000
    reached, claimed = (
        sum(checker.check(HeadMode.POSE, *pose).reachable for pose in tried)
        for tried in (poses.reachable(tip, random, count), poses.beyond(tip, random, 200, nearest=1.05))
    )
    points = random.uniform(-2.0, 2.0, size=(count, 3))
    seen = sum(checker.check(HeadMode.LOOK_AT, point, np.zeros(4)).reachable for point in points)
    found = (
        f"{100 * reached / count:.1f} %, {claimed} of 200; {100 * seen / count:.1f} % of points within 2 m"
    )
    return [("head poses as IK; points that waist and head can look at", ">= 99 %, 0 of 200", found)]


def repeating(quick: bool) -> list[Row]:
    """The state's hash after ten seconds."""

    def run(seed: int) -> str:
        robot = Lockstep(MODEL, seed=seed, noise=NOISE)
        robot.planner.velocity(0.2, 0.0, 0.1)
        robot.run(5.0)
        return robot.simulator.hash()

    same, other = run(1) == run(1), run(1) == run(2)
    return [("state hash of two runs; of another seed", "equal; not", f"{same}; {other}")]


def speed(quick: bool) -> list[Row]:
    """Real-time factors, of physics alone and of everything."""
    simulator = Simulator(MODEL)
    began = time.process_time()
    for _ in range(500):
        simulator.step()
    physics = 2.0 / (time.process_time() - began)
    robot = Lockstep(MODEL, noise=NOISE)
    robot.planner.velocity(0.2, 0.0, 0.0)
    robot.run(1.0)
    began = time.process_time()
    robot.run(5.0)
    whole = 5.0 / (time.process_time() - began)
    return [
        ("physics alone, CPU", "", f"{physics:.0f} x real time"),
        (
            "simulator, estimator, planner, controller while walking, CPU",
            ">= 1 x",
            f"{whole:.1f} x real time",
        ),
    ]


def bodies(quick: bool) -> list[Row]:
    """The bodies of the tests, which are not ours, by `--model`'s way."""
    texts = {
        "ours": shorter_legs(0.0),
        "legs 5 % shorter": shorter_legs(0.05),
        "legs 20 % shorter": shorter_legs(0.2),
        "offset hips, arms of 7 joints, no neck": offset_hips(),
    }
    rows = []
    for name, text in texts.items():
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "robot.xml"
            path.write_text(text, encoding="utf-8")
            body = load_external(path)
        speeds, errors, falls = [], [], 0
        for seed in range(1 if quick else 3):
            robot = Lockstep(body, seed=seed, noise=NOISE)
            robot.run(0.5)
            robot.go_to((2.0, 0.0, 0.0))
            # The first and the last step are short.
            first, last = robot.touchdowns[1], robot.touchdowns[-2]
            way = float(np.linalg.norm((last.landed - first.landed)[:2]))
            speeds.append(way / ((last.stamp - first.stamp) * 1e-9))
            errors.append(robot.foot_error()[0])
            falls += robot.fell
        found = f"{falls} falls, {min(speeds):.2f} m/s, {max(errors) * 1e3:.1f} mm rms"
        rows.append((f"body: {name}, worst of {len(speeds)}", ">= 0.2 m/s, <= 20 mm rms", found))
    return rows


if __name__ == "__main__":
    main()
