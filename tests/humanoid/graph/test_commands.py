"""Bad messages on every topic of the robot: they are refused, counted and logged, and never reach a joint."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import Twist, Vector3, Wrench, WrenchStamped
from humanoid.data import SECOND, Footstep, JointCommand, Leg, Mode
from humanoid.data import FootstepPlan as Plan
from humanoid.robot.table import JOINT_NAMES
from humanoid.ros import messages
from humanoid_interfaces.msg import FootstepPlan
from nav_msgs.msg import Odometry
from rclpy.duration import Duration
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Imu, JointState
from std_msgs.msg import Float64MultiArray

from tests.humanoid.graph.robot import LATCHED, MOTION, WALKING, Robot, walk

MakeRobot = Callable[..., Robot]
NAN, INFINITE = math.nan, math.inf
# The controller does not even receive from publishers that offer no deadline.
NEWEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT, deadline=Duration(seconds=0.02))
COMMANDS = "/whole_body_position_controller/commands"
ZEROS = [0.0] * 29


def reports_of(robot: Robot) -> dict[str, DiagnosticStatus]:
    """The newest report of each part, by name."""
    reports: dict[str, DiagnosticStatus] = {}
    robot.listen(DiagnosticArray, "/diagnostics", lambda m: reports.update((s.name, s) for s in m.status))
    return reports


def counts(report: DiagnosticStatus) -> dict[str, int]:
    return {value.key: int(value.value) for value in report.values}


def bad_commands(robot: Robot) -> Iterator[Float64MultiArray]:
    """Publish set-points that no servo may follow, over and over."""
    while True:
        stamp = robot.physics.stamp
        for position in ([NAN] * 29, [*ZEROS[1:], INFINITE], [100.0] * 29, ZEROS[:28], [], ZEROS * 40):
            yield messages.command(JointCommand(stamp, np.array(position)))
        for wrong in (stamp - SECOND, 0, stamp + 5 * SECOND, stamp - 8_000_000):
            yield messages.command(JointCommand(max(wrong, 0), np.array(ZEROS)))
        yield Float64MultiArray(data=ZEROS)  # good, but another node commands


def bad_plans() -> Iterator[FootstepPlan]:
    while True:
        for x in (NAN, INFINITE):
            yield messages.footstep_plan(Plan(0, (Footstep(0, Leg.LEFT, x, 0.09, 0.0),), (0, 0, 0)), 0)
        plan = messages.footstep_plan(Plan(0, (Footstep(0, Leg.LEFT, 0.1, 0.09, 0.0),), (0, 0, 0)), 0)
        plan.steps[0].leg = 7
        yield plan


def test_no_bad_set_point_reaches_a_joint(make_robot: MakeRobot) -> None:
    robot = make_robot(*WALKING)
    reports = reports_of(robot)
    robot.run(1.0)
    goal = robot.send(walk(1.2))
    before = len(robot.setpoints)
    send, bad = robot.publisher(Float64MultiArray, COMMANDS), bad_commands(robot)
    while robot.gait.footstep_index < 3:
        send(next(bad))
        robot.run(0.008)
    assert robot.mode is Mode.WALKING
    status, _ = robot.result(goal)
    assert status == GoalStatus.STATUS_SUCCEEDED
    assert not robot.fell
    followed = np.array(robot.setpoints[before:])
    assert np.isfinite(followed).all()
    assert (np.abs(followed).max(axis=1) > 0.05).all()  # never the zeros of another publisher
    assert np.abs(np.diff(followed, axis=0)).max() < 0.5
    robot.run(1.0)
    report = reports["joint_controller: commands"]
    refused = counts(report)
    assert min(refused[why] for why in ("not_finite", "out_of_range", "wrong_size", "late", "second")) > 5
    assert refused["missing"] == 0
    assert report.level == DiagnosticStatus.OK  # nothing was refused lately
    robot.expect("joint_controller", "set-points refused (")


@pytest.mark.slow
def test_no_bad_reading_plan_posture_velocity_or_push_does_harm(make_robot: MakeRobot) -> None:
    # A bad reading can displace a good one from a queue of one, and then nobody answers the tick.
    robot = make_robot(*WALKING, humanoid_simulator={"patience": 0.02})
    reports = reports_of(robot)
    robot.run(1.0)
    goal = robot.send(walk(1.2))
    names = list(JOINT_NAMES)
    plans = bad_plans()
    attacks: list[tuple[Callable[[Any], None], Callable[[], Any]]] = [
        (robot.publisher(kind, topic, qos), make)
        for kind, topic, qos, make in (
            (JointState, "/joint_states", NEWEST, lambda: joints(robot, names, [NAN] * 29)),
            (JointState, "/joint_states", NEWEST, lambda: joints(robot, names, [50.0] * 29)),
            (JointState, "/joint_states", NEWEST, lambda: joints(robot, names, [0.0] * 3)),
            (JointState, "/joint_states", NEWEST, lambda: joints(robot, ["tail"], [0.0])),
            (JointState, "/joint_states", NEWEST, lambda: joints(robot, names, ZEROS, late=8_000_000)),
            (JointState, "/joint_states", NEWEST, lambda: joints(robot, names, ZEROS, late=SECOND)),
            (Imu, "/imu/data", NEWEST, lambda: imu(robot, NAN)),
            (Imu, "/imu/data", NEWEST, lambda: imu(robot, 1e9)),
            (Odometry, "/odom", NEWEST, lambda: odometry(robot, NAN)),
            (Odometry, "/odom", NEWEST, lambda: odometry(robot, 3.0)),
            (WrenchStamped, "/l_foot/wrench", NEWEST, lambda: wrench(robot, INFINITE)),
            (FootstepPlan, "/footsteps/plan", 1, lambda: next(plans)),
            (JointState, "/posture", 1, lambda: JointState(name=names[12:], position=[INFINITE] * 17)),
            (JointState, "/posture", 1, lambda: JointState(name=["tail"], position=[0.0])),
            (Twist, "/humanoid/cmd_vel", 1, lambda: Twist(linear=Vector3(x=NAN))),
            (WrenchStamped, "/humanoid_simulator/push", 10, lambda: wrench(robot, NAN)),
            (WrenchStamped, "/humanoid_simulator/push", 10, lambda: wrench(robot, 1e12)),
        )
    ]
    while robot.gait.footstep_index < 4:
        for send, make in attacks:
            send(make())
            robot.run(0.02)
    status, _ = robot.result(goal)
    assert status == GoalStatus.STATUS_SUCCEEDED
    assert np.hypot(*robot.physics.sole_truth().centre[:2] - [1.2, 0.0]) < 0.06
    assert not robot.fell
    assert np.isfinite(robot.setpoints).all()
    robot.run(1.0)
    inputs = counts(reports["whole_body_controller: inputs"])
    assert min(inputs[kind] for kind in ("readings", "postures")) > 5
    planner = counts(reports["gait_planner: commands"])
    assert min(planner["plans"], planner["velocities"]) > 5
    assert counts(reports["humanoid_simulator: commands"])["pushes"] > 5
    assert counts(reports["imu_fusion: inputs"])["readings"] > 5
    for node, kind in (
        ("whole_body_controller", "readings"),
        ("whole_body_controller", "postures"),
        ("imu_fusion", "readings"),
        ("gait_planner", "plans"),
        ("gait_planner", "velocities"),
        ("humanoid_simulator", "pushes"),
    ):
        robot.expect(node, f"{kind} refused (")


def test_commands_that_come_late_or_not_at_all_end_in_the_servos_own_stance(make_robot: MakeRobot) -> None:
    robot = make_robot(*MOTION)
    reports = reports_of(robot)
    robot.run(1.0)
    controller: Any = robot.nodes["whole_body_controller"]
    publish = controller.publish_whole_body_position_controller_commands

    def publish_nothing_good(message: Float64MultiArray) -> None:
        message.data[3] = NAN
        publish(message)

    controller.publish_whole_body_position_controller_commands = publish_nothing_good
    robot.run(1.5)
    assert np.isfinite(robot.setpoints).all()
    assert not robot.fell
    assert robot.standby.startswith("no good command for 0.0")
    report = reports["joint_controller: commands"]
    assert report.level == DiagnosticStatus.ERROR
    assert report.message == robot.standby
    assert counts(report)["not_finite"] > 100
    controller.publish_whole_body_position_controller_commands = publish
    robot.run(1.5)
    assert robot.standby == ""
    robot.expect("joint_controller", "whole_body_controller controls the servos again")


def test_a_node_on_the_wall_clock_is_told_what_to_do(make_robot: MakeRobot) -> None:
    """The first mistake of everybody: the node was started without use_sim_time."""
    robot = make_robot(*MOTION)
    robot.until(lambda: robot.mode is Mode.STANDING)
    words = (
        "has the time of the wall clock, but the robot's time is simulated: start the node that sends it with"
    )
    wall = time.time_ns()
    plan = Plan(7, (Footstep(0, Leg.LEFT, 0.1, 0.09, 0.0),), (0, 0, 0))
    robot.publisher(FootstepPlan, "/footsteps/upcoming", LATCHED)(messages.footstep_plan(plan, wall))
    robot.expect("whole_body_controller", words)
    command = JointCommand(wall, np.zeros(len(JOINT_NAMES)))
    send = robot.publisher(Float64MultiArray, COMMANDS)
    for _ in range(20):  # commands of the controller take the only place in the queue
        send(messages.command(command))
        robot.run(0.008)
    robot.expect("joint_controller", words)
    assert robot.mode is Mode.STANDING


def joints(robot: Robot, names: list[str], positions: list[float], late: int = 0) -> JointState:
    stamped = messages.header(robot.physics.stamp - late, "")
    return JointState(header=stamped, name=names, position=positions, velocity=positions, effort=positions)


def imu(robot: Robot, number: float) -> Imu:
    message = Imu(header=messages.header(robot.physics.stamp, ""))
    message.orientation.x = number
    return message


def odometry(robot: Robot, number: float) -> Odometry:
    message = Odometry(header=messages.header(robot.physics.stamp, "odom"))
    message.pose.pose.position.x = number
    return message


def wrench(robot: Robot, number: float) -> WrenchStamped:
    stamped = messages.header(robot.physics.stamp, "")
    return WrenchStamped(header=stamped, wrench=Wrench(force=Vector3(y=number)))
