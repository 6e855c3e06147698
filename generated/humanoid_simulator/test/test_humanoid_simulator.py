"""Tests of what the node humanoid_simulator does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")
pytest.importorskip("mujoco", reason="the simulation needs MuJoCo")

from humanoid_simulator import _humanoid_simulator_base as base
from humanoid_simulator.humanoid_simulator import HumanoidSimulator
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

PERIOD = 4_000_000  # ns


def test_time_waits_for_the_set_points_of_each_tick(ros: Any) -> None:
    node = ros.start(HumanoidSimulator, Parameter("patience", value=60.0), use_sim_time=False)
    ros.hurry(node.pace_timer)
    servos = ros.peer.create_publisher(JointState, "/joint_commands", base.JOINT_COMMANDS_SUBSCRIPTION_QOS)
    states: list[JointState] = []
    times: list[int] = []
    ros.peer.create_subscription(
        JointState, "/joint_encoders", states.append, base.JOINT_ENCODERS_PUBLISHER_QOS
    )
    ros.peer.create_subscription(
        Clock, "/clock", lambda message: times.append(message.clock.nanosec), base.CLOCK_PUBLISHER_QOS
    )
    standing = node.simulator.sensors().joints.position.tolist()
    names = [node.simulator.model.mj.actuator(number).name for number in node.simulator.model.actuators]
    for tick in range(3):

        def answer(stamp: int = tick * PERIOD) -> None:
            message = JointState(name=names, position=standing)
            message.header.stamp.nanosec = stamp
            servos.publish(message)

        ros.deliver(answer, lambda tick=tick: node.stamp == (tick + 1) * PERIOD, "step")
        assert not ros.spins_until(lambda tick=tick: node.stamp > (tick + 1) * PERIOD, 0.1)
    assert times == sorted(times)
    assert states[-1].name == names
    assert states[-1].header.stamp.nanosec == node.stamp


def test_set_points_for_too_few_joints_move_nothing(ros: Any) -> None:
    node = ros.start(HumanoidSimulator, use_sim_time=False)
    servos = ros.peer.create_publisher(JointState, "/joint_commands", base.JOINT_COMMANDS_SUBSCRIPTION_QOS)
    few = JointState(name=["l_knee"], position=[0.1])
    ros.deliver(lambda: servos.publish(few), lambda: node._health.counts["set-points"], "refusal")
    assert node.stamp == 0


def test_other_obstacles_stand_there_after_a_reset(ros: Any) -> None:
    node = ros.start(HumanoidSimulator, use_sim_time=False)

    def set_parameter(name: str, value: Any) -> str:
        result = node.set_parameters([Parameter(name, value=value)])[0]
        return "" if result.successful else str(result.reason)

    assert set_parameter("obstacles", ["red_box 1.5 0.1"]) == ""
    assert node.simulator.obstacles.solids == ()
    node.handle_reset(Trigger.Request(), Trigger.Response())
    assert [solid.name for solid in node.simulator.obstacles.solids] == ["red_box"]
    assert set_parameter("random_obstacles.count", 2) == ""
    assert set_parameter("obstacles", ["tree 1 1"]).startswith("obstacles: 'tree 1 1'")
    free = "random_obstacles.free: expected x and y of each place: an even count"
    assert set_parameter("random_obstacles.free", [0.0, 0.0, 1.0]) == free
    node.handle_reset(Trigger.Request(), Trigger.Response())
    assert len(node.simulator.obstacles.solids) == 3
    assert node.stamp == 0
