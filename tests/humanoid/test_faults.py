"""Faults: dead nodes, bad commands and readings, the emergency stop. The robot stands, and says why."""

from __future__ import annotations

import math

import numpy as np
import pytest
from humanoid.control.controller import WholeBodyController
from humanoid.control.reference import straight_steps
from humanoid.data import (
    Cause,
    EmergencyStop,
    Footstep,
    FootstepPlan,
    JointCommand,
    JointStates,
    Leg,
    Mode,
    Posture,
    Support,
)
from humanoid.planning.footsteps import plan_footsteps
from humanoid.robot.model import HumanoidModel
from humanoid.simulation.safety import LATEST, MISSING_AFTER, CommandGate, EmergencyStopLatch
from humanoid.simulation.sim import Noise
from humanoid.spatial import Array
from humanoid.trials.harness import Lockstep
from humanoid.trials.trials import STRAIGHT

NOISE = Noise()


def _walking(model: HumanoidModel, seed: int, seconds: float) -> Lockstep:
    robot = Lockstep(model, seed=seed, noise=NOISE)
    robot.run(0.5)
    robot.planner.walk(plan_footsteps(robot.controller.state().stance, (2.0, 0.6, 1.0)).plan)
    robot.run(seconds)
    return robot


def _both_feet_down_after(robot: Lockstep) -> float:
    """Seconds until both soles are on the floor, where they stay for two seconds."""
    soles = [robot.model.frames[f"{side}_sole"] for side in "lr"]
    began, down = robot.time, 0.0
    while robot.time < began + 2.5 and not robot.fell:
        robot.tick()
        if robot.simulator.data.site_xpos[soles, 2].max() > 0.008:
            down = robot.time - began
    assert not robot.fell
    assert robot.simulator.sole_truth().support is Support.BOTH
    return down


@pytest.mark.parametrize(
    ("node", "why"),
    [
        ("gait_planner", "gait_planner has been silent"),
        pytest.param("state_estimator", "no odometry", marks=pytest.mark.slow),
        pytest.param("whole_body_controller", "no good command", marks=pytest.mark.slow),
    ],
)
def test_a_node_dies_in_the_middle_of_a_step(model: HumanoidModel, node: str, why: str) -> None:
    for seed, moment in enumerate((2.35, 2.05, 4.2)):
        robot = _walking(model, seed, moment)
        robot.dead.add(node)
        assert _both_feet_down_after(robot) <= 1.0
        reason = robot.standby.reason if node == "whole_body_controller" else robot.controller.state().reason
        assert why in reason
        if node != "whole_body_controller":
            assert robot.controller.mode is Mode.HOLDING
            assert why in robot.controller.follow(FootstepPlan(9, straight_steps(3, 0.1, 0.18), (0, 0, 0)))


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize("node", ["gait_planner", "state_estimator", "whole_body_controller"])
def test_nodes_die_at_any_moment(model: HumanoidModel, node: str) -> None:
    random = np.random.default_rng(7)
    for seed in range(15):
        robot = _walking(model, seed, random.uniform(0.2, 8.0))
        robot.dead.add(node)
        robot.run(3.0)
        assert not robot.fell


@pytest.mark.parametrize("seed", [0, 1])
def test_the_controller_goes_on_from_where_the_servos_have_brought_the_robot(
    model: HumanoidModel, seed: int
) -> None:
    robot = _walking(model, seed, 2.1)
    robot.dead.add("whole_body_controller")
    robot.run(0.2)
    robot.dead.clear()
    robot.run(0.3)
    assert robot.standby.reason
    before = robot.simulator.sole_truth()
    robot.simulator.push(np.array([200.0, 0.0, 0.0]), 0.1)
    robot.run(1.5)
    after = robot.simulator.sole_truth()
    moved = [math.dist(foot[:2], there[:2]) for foot, there in zip(before.feet, after.feet, strict=True)]
    assert max(moved) > 0.1, "it was to need a step"
    robot.run(4.0)
    assert robot.standby.reason == ""
    assert robot.controller.mode is Mode.STANDING
    assert robot.go_to((2.0, 0.6, 0.0)) < 0.06
    assert not robot.fell


def test_a_controller_stands_where_somebody_else_has_put_the_robot(model: HumanoidModel) -> None:
    """As the servos on their own do. They let go once its set-points agree with theirs."""
    robot = _walking(model, 1, 2.3)
    stubborn, other = WholeBodyController(model), WholeBodyController(model)
    beside = Lockstep(model, seed=1, noise=NOISE)
    sensors = beside.simulator.sensors()
    for controller in (stubborn, other):
        controller.tick(beside.simulator.stamp, sensors.joints, sensors.imu, beside.simulator.truth())
    robot.controller.hold("one foot is ahead")
    robot.run(2.0)
    for _ in range(250):
        now, sensors = robot.simulator.stamp, robot.simulator.sensors()
        other.begin_here()
        commands = [
            controller.tick(now, sensors.joints, sensors.imu, robot.odometry).position
            for controller in (robot.controller, other, stubborn)
        ]
        robot.simulator.apply(JointCommand(now, commands[0]))
        robot.simulator.step()
        robot.odometry = robot.estimator.update(sensors.joints, sensors.imu, sensors.wrenches, robot.gait)
    assert np.abs(commands[1] - commands[0]).max() < 0.1
    assert np.abs(commands[2] - commands[0]).max() > 0.3


def test_holding_ends_when_somebody_says_so(model: HumanoidModel) -> None:
    robot = _walking(model, 1, 2.3)
    robot.controller.hold("somebody knocked")
    robot.controller.hold("something else")
    robot.run(1.5)
    assert robot.controller.state().reason == "somebody knocked"
    robot.planner.cancel()
    robot.controller.resume()
    robot.settle(5.0)
    assert robot.controller.mode is Mode.STANDING
    assert robot.go_to((0.5, 0.0, 0.0)) < 0.06
    assert not robot.fell


def test_emergency_stop_beats_everything(model: HumanoidModel) -> None:
    robot = _walking(model, 2, 2.4)
    robot.controller.emergency_stop(EmergencyStop(True, Cause.OPERATOR, "/teleop", "red button"))
    assert _both_feet_down_after(robot) <= 1.0
    state = robot.controller.state()
    assert state.mode is Mode.EMERGENCY_STOP
    assert state.reason == "/teleop: red button"
    steps = straight_steps(4, 0.1, 0.18)
    assert "red button" in robot.controller.follow(FootstepPlan(50, steps, (0.3, 0.0, 0.0)))
    taken = len(robot.touchdowns)
    robot.planner.velocity(0.2, 0.0, 0.0)
    robot.run(1.0)
    assert len(robot.touchdowns) == taken
    robot.controller.emergency_stop(EmergencyStop(False))
    robot.run(3.0)
    assert len(robot.touchdowns) > taken
    assert not robot.fell


def test_a_late_joiner_hears_of_the_stop(model: HumanoidModel) -> None:
    controller = WholeBodyController(model)
    controller.emergency_stop(EmergencyStop(True, Cause.BATTERY, "/battery_monitor", "3 % left"))
    steps = straight_steps(4, 0.1, 0.18)
    assert "3 % left" in controller.follow(FootstepPlan(1, steps, (0.3, 0.0, 0.0)))
    assert controller.mode is Mode.EMERGENCY_STOP


@pytest.mark.parametrize("when", [1.7, 2.0, 2.5])
def test_a_hasty_landing_does_not_lose_the_robot(model: HumanoidModel, when: float) -> None:
    """Feet hover and slide until the weight comes onto them."""
    robot = Lockstep(model, seed=0, noise=Noise())
    robot.run(0.5)
    robot.controller.follow(STRAIGHT)
    robot.run(when + 0.5)

    def lost() -> Array:
        assert robot.odometry is not None
        return (robot.odometry.position - robot.simulator.truth().position)[:2]

    before = lost()
    robot.controller.emergency_stop(EmergencyStop(True, Cause.OPERATOR, "/teleop", "red button"))
    robot.run(2.0)
    assert not robot.fell
    assert np.linalg.norm(lost() - before) < 0.010


def test_the_latch_is_lifted_by_nobody_who_still_asks() -> None:
    latch = EmergencyStopLatch()
    assert not latch.status.active
    first = latch.request("/a", Cause.FALL, "fell", 5)
    assert first is not None
    assert (first.active, first.cause, first.source, first.reason, first.stamp) == (
        True,
        Cause.FALL,
        "/a",
        "fell",
        5,
    )
    assert latch.request("/b", Cause.LIMIT, "too hot", 6) is None
    latch.withdraw("/a")
    assert latch.status.active
    assert latch.reset(7) == (False, "/b still requests the stop: too hot")
    latch.withdraw("/b")
    assert latch.reset(8) == (True, "")
    assert (latch.status.active, latch.status.cause, latch.status.source) == (False, Cause.FALL, "/a")


def test_bad_commands_are_refused_and_counted() -> None:
    lower, upper = -np.ones(29), np.ones(29)
    gate = CommandGate(lower, upper)
    good = np.full(29, 0.5)
    now = 1_000_000_000
    assert gate.accept(JointCommand(now, good), now)
    broken = good.copy()
    broken[3] = math.nan
    assert not gate.accept(JointCommand(now, broken), now)
    assert "position 3 " in gate.reason
    assert not gate.accept(JointCommand(now, np.full(29, 100.0)), now)
    assert not gate.accept(JointCommand(now, np.zeros(28)), now)
    assert "28" in gate.reason
    assert not gate.accept(JointCommand(now - LATEST - 1, np.zeros(29)), now)
    assert "late" in gate.reason
    counts = gate.refusals
    assert (counts.not_finite, counts.out_of_range, counts.wrong_size, counts.late) == (1, 1, 1, 1)
    assert counts.total == 4
    assert np.array_equal(gate.setpoints(now), good)
    assert counts.missing == 0
    assert np.array_equal(gate.setpoints(now + MISSING_AFTER + 1), good)
    assert counts.missing == 1


def test_a_command_that_is_no_number_never_reaches_a_joint(model: HumanoidModel) -> None:
    robot = Lockstep(model, seed=1, noise=NOISE)
    robot.run(0.5)
    for _ in range(100):
        robot.simulator.apply(JointCommand(robot.simulator.stamp, np.full(29, math.inf)))
        robot.tick()
    assert robot.simulator.gate.refusals.not_finite == 100
    assert np.isfinite(robot.simulator.data.ctrl).all()
    assert not robot.fell


@pytest.mark.slow
def test_readings_that_are_no_numbers_are_left_out(model: HumanoidModel) -> None:
    robot = _walking(model, 3, 2.4)
    honest = robot.simulator.sensors

    def broken_now_and_then() -> object:
        sensors = honest()
        if robot.simulator.stamp // 4_000_000 % 7 == 0:
            sensors.joints = JointStates(
                sensors.stamp, np.full(29, math.nan), sensors.joints.velocity, sensors.joints.effort
            )
        return sensors

    robot.simulator.sensors = broken_now_and_then  # type: ignore[method-assign,assignment]
    robot.settle(20.0)
    assert not robot.fell
    assert robot.controller.mode is Mode.STANDING
    assert robot.distance_to((2.0, 0.6, 1.0)) < 0.10
    assert robot.controller.inputs.refusals.not_finite > 100
    assert robot.estimator.refused > 100
    assert np.isfinite(robot.simulator.data.qpos).all()


def _step(index: int, leg: Leg, x: float, y: float, step_time: float = 0.6) -> Footstep:
    return Footstep(index, leg, x, y, 0.0, step_time)


@pytest.mark.parametrize(
    ("steps", "words"),
    [
        ([_step(0, Leg.LEFT, math.nan, 0.09)], "not a position, angle or time"),
        ([_step(0, Leg.LEFT, 0.1, 0.09, math.inf)], "not a position, angle or time"),
        ([_step(0, Leg.LEFT, 0.1, 0.09, 0.3)], "takes 0.30 s; 0.4 s at least"),
        ([_step(0, Leg.LEFT, 0.1, 0.09), _step(1, Leg.LEFT, 0.2, 0.09)], "step 1 moves the left leg twice"),
        ([_step(0, Leg.LEFT, 0.9, 0.09)], "0.92 m from the other foot"),
        ([_step(0, Leg.LEFT, 0.1, -0.05)], "too close to the other foot"),
    ],
)
def test_plans_that_no_leg_can_follow_are_refused(
    model: HumanoidModel, steps: list[Footstep], words: str
) -> None:
    controller = WholeBodyController(model)
    assert words in controller.follow(FootstepPlan(1, tuple(steps), (0.0, 0.0, 0.0)))
    assert controller.stepping.steps == []


def test_postures_without_numbers_are_refused(model: HumanoidModel) -> None:
    controller = WholeBodyController(model)
    assert "17 finite positions" in controller.posture(Posture(np.full(17, math.nan)))
    assert "17 finite positions" in controller.posture(Posture(np.zeros(16)))
    assert controller.posture(Posture(np.zeros(17))) == ""
    assert controller.inputs.refusals.not_finite == 2


def test_a_fallen_robot_lies_still_and_says_so(model: HumanoidModel) -> None:
    robot = Lockstep(model, seed=1, noise=NOISE)
    robot.run(0.3)
    robot.simulator.push(np.array([0.0, 600.0, 0.0]), 0.2)
    for _ in range(500):
        robot.tick()
    assert robot.controller.mode is Mode.FALLEN
    state = robot.controller.state()
    assert state.reason == "the robot has fallen"
    assert state.stance.support is Support.NONE
    speed = np.abs(robot.simulator.data.qvel).max()
    assert speed < 3.0
    assert "fallen" in robot.controller.follow(FootstepPlan(1, straight_steps(3, 0.1, 0.18), (0, 0, 0)))
