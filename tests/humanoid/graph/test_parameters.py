"""Parameters of nodes: each one is read, and setting it changes what the robot does."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from geometry_msgs.msg import Twist
from humanoid import data
from humanoid.control.pace import Pace
from humanoid.data import Leg, Mode, Stance, Support
from humanoid.ros import messages
from humanoid_interfaces.action import PerformDance
from humanoid_interfaces.msg import FootstepPlan, GaitState
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Joy

from tests.humanoid.graph.robot import LATCHED, MOTION, PLANNING, Robot, walk

MakeRobot = Callable[..., Robot]
ROOT = Path(__file__).parents[3]
NODES = sorted(
    path
    for path in (ROOT / "generated").glob("*/*/*.py")
    if path.stem == path.parents[1].name and "from humanoid." in path.read_text(encoding="utf-8")
)
NEWEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
BUTTON = [0, 0, 0, 0, 1]  # of the dead man, as the joystick sends them


@pytest.mark.parametrize("path", NODES, ids=lambda path: path.stem)
def test_every_parameter_is_read(path: Path) -> None:
    description = f"interfaces/{path.stem}/nodl/{path.stem}.nodl.yaml"
    text = (ROOT / description).read_text(encoding="utf-8")
    source = path.read_text(encoding="utf-8")
    of_timers = set(re.findall(r"period_param: (\w+)", text))  # which the base class reads
    unread = [
        name
        for name in yaml.safe_load(text).get("parameters", ())
        if name not in of_timers and not re.search(rf"\.{name.rpartition('.')[2]}\b(?! = )", source)
    ]
    assert unread == []


@pytest.mark.parametrize("velocity", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)])
def test_the_parameters_of_the_gait_planner_shape_the_steps_of_a_velocity(
    make_robot: MakeRobot, velocity: tuple[float, float, float]
) -> None:
    pace = Pace(0.1)
    limits = {"walking_speed": pace.speed, "step.sideways_max": 0.02, "step.turn_max": 0.1}
    parameters = limits | {"stance_width": 0.2}
    robot = make_robot(*MOTION, gait_planner=parameters)
    robot.until(lambda: robot.mode is Mode.STANDING)
    plans: list[data.FootstepPlan] = []
    robot.listen(FootstepPlan, "/footsteps/upcoming", lambda m: plans.append(messages.read_footstep_plan(m)))
    steer = Twist()
    steer.linear.x, steer.linear.y, steer.angular.z = velocity
    robot.publisher(Twist, "/humanoid/cmd_vel")(steer)
    robot.until(lambda: bool(plans and plans[-1].steps))
    first, second, *_ = plans[-1].steps
    assert (first.step_time, second.step_time) == (pace.step_time, pace.step_time)
    if velocity[0]:
        assert (first.x, second.x) == pytest.approx((pace.step_length, 2 * pace.step_length), abs=0.01)
        assert abs(first.y - second.y) == pytest.approx(0.2, abs=0.01)
    elif velocity[1]:
        assert first.leg is Leg.LEFT
        assert first.y == pytest.approx(0.12, abs=0.01)  # half of the width, and a step aside
    else:
        assert (first.yaw, second.yaw) == pytest.approx((0.1, 0.15), abs=0.01)


@pytest.mark.parametrize("timeout", [0.05, 0.3])
def test_how_long_the_controller_goes_without_odometry(make_robot: MakeRobot, timeout: float) -> None:
    robot = make_robot(*MOTION, whole_body_controller={"control.input_timeout": timeout})
    robot.until(lambda: robot.mode is Mode.STANDING)
    robot.kill("imu_fusion")
    killed = robot.now
    robot.until(lambda: robot.mode is Mode.HOLDING or robot.now > killed + 1.0)
    assert robot.gait.reason.startswith("no odometry from imu_fusion")
    assert robot.now - killed == pytest.approx(timeout, abs=0.03)
    assert not robot.fell


def test_how_fast_legs_overrule_the_imu(make_robot: MakeRobot) -> None:
    def jitter(**parameters: float) -> np.ndarray[Any, Any]:
        robot = make_robot(*MOTION, imu_fusion=parameters)
        found: list[list[float]] = []

        def hear(message: Odometry) -> None:
            velocity, place = message.twist.twist.linear, message.pose.pose.position
            found.append([velocity.x, velocity.y, place.x, place.y])

        robot.listen(Odometry, "/odom", hear, NEWEST)
        robot.until(lambda: len(found) >= 60)
        robot.close()
        return np.std(np.diff(found[10:60], axis=0), axis=0)

    usual = jitter()
    at_once = jitter(velocity_time_constant=0.001), jitter(position_time_constant=0.001)
    # Nothing smooths the noisy readings of the legs any longer.
    assert at_once[0][0] > 1.5 * usual[0], (usual, at_once)
    assert at_once[1][2] > 1.5 * usual[2], (usual, at_once)


@pytest.mark.parametrize("distance", [0.02, 0.04])
def test_how_far_off_a_step_leads_to_a_new_plan(
    make_robot: MakeRobot, ros_executor: Any, distance: float
) -> None:
    robot = make_robot(
        *PLANNING,
        "navigation_action_server",
        navigation_action_server={"replan_distance": distance},
    )
    tell = robot.publisher(GaitState, "/gait_state", LATCHED)
    plans: list[data.FootstepPlan] = []
    robot.listen(FootstepPlan, "/footsteps/plan", lambda m: plans.append(messages.read_footstep_plan(m)))
    feet = [np.array([0.0, 0.09, 0.0]), np.array([0.0, -0.09, 0.0])]

    def say(mode: Mode, support: Support, index: int) -> None:
        stance = Stance(support, (feet[0], feet[1]))
        tell(messages.gait_state(data.GaitState(1, mode, "", stance, 1, index, 0.5)))
        for _ in range(20):  # without a simulator there is no time: everything happens at once
            ros_executor.spin_once(timeout_sec=0.01)

    say(Mode.STANDING, Support.BOTH, 0)
    handle = robot.send(walk(1.0))
    assert handle.accepted
    while not plans:  # a plan that was asked for is there at the next gait state
        say(Mode.STANDING, Support.BOTH, 0)
    first = plans[0]
    step = first.steps[0]
    feet[step.leg.side] = step.pose + np.array([0.03, 0.0, 0.0])
    for _ in range(3):
        say(Mode.WALKING, Support.LEFT if step.leg is Leg.LEFT else Support.RIGHT, 1)
    assert any(plan.steps != first.steps for plan in plans) == (distance < 0.03)


def test_only_the_dances_of_the_parameter_are_danced(make_robot: MakeRobot) -> None:
    robot = make_robot(*MOTION, "dance_action_server", dance_action_server={"dances": ["wave"]})
    robot.until(lambda: robot.mode is Mode.STANDING)
    assert not robot.send(PerformDance.Goal(dance="disco")).accepted
    robot.expect("dance_action_server", "goal rejected: there is no dance 'disco'; I know wave")
    assert robot.send(PerformDance.Goal(dance="wave")).accepted


@pytest.mark.parametrize("timeout", [0.1, 1.0])
def test_how_long_a_velocity_of_the_joystick_holds(make_robot: MakeRobot, timeout: float) -> None:
    robot = make_robot(*MOTION, "teleop", "footstep_planner", teleop={"joy_timeout": timeout})
    heard: list[tuple[float, float]] = []
    robot.listen(Twist, "/humanoid/cmd_vel", lambda m: heard.append((robot.now, m.linear.x)))
    press = robot.publisher(Joy, "/joy", NEWEST)
    robot.until(lambda: robot.mode is Mode.STANDING)
    pressed = robot.now
    press(Joy(axes=[0.0, 1.0, 0.0], buttons=BUTTON))
    robot.until(lambda: bool(heard) and heard[-1][1] > 0)
    robot.until(lambda: heard[-1][1] < max(x for _, x in heard))
    assert heard[-1][0] - pressed == pytest.approx(timeout, abs=0.2)
