"""What joint_state_publisher publishes, by its parameters, on either rclpy."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import rclpy
from rclpy.parameter import Parameter
from robot_state_publisher.joint_state_publisher import JointStatePublisher
from robot_state_publisher.urdf import UrdfError
from sensor_msgs.msg import JointState

URDF = """
<robot name="arm">
  <link name="base"/><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="a"/><limit lower="1" upper="3"/>
    <safety_controller soft_lower_limit="1.5" soft_upper_limit="1.7"/></joint>
  <joint name="left" type="revolute"><parent link="a"/><child link="b"/><limit lower="-1" upper="1"/></joint>
  <joint name="right" type="revolute"><parent link="a"/><child link="c"/><limit lower="-1" upper="1"/>
    <mimic joint="left" multiplier="-1" offset="0.25"/></joint>
  <joint name="wheel" type="continuous"><parent link="a"/><child link="d"/></joint>
</robot>
"""
Make = Callable[..., JointStatePublisher]


@pytest.fixture
def make() -> Iterator[Make]:
    rclpy.init()
    made: list[JointStatePublisher] = []

    def make(text: str = URDF, **parameters: Any) -> JointStatePublisher:
        overrides = [Parameter(name.replace("__", "."), value=value) for name, value in parameters.items()]
        made.append(JointStatePublisher(text, parameter_overrides=overrides))
        return made[-1]

    yield make
    for node in made:
        node.destroy_node()
    rclpy.shutdown()


def published(node: JointStatePublisher) -> Any:
    states: list[Any] = []
    subscription = node.create_subscription(JointState, "joint_states", states.append, 10)
    while not states:
        rclpy.spin_once(node, timeout_sec=5)
    node.destroy_subscription(subscription)
    return states[-1]


def positions(node: JointStatePublisher) -> dict[str, float]:
    state = published(node)
    return dict(zip(state.name, state.position, strict=True))


def test_defaults(make: Make) -> None:
    node = make(rate=100.0)
    assert positions(node) == {"lift": 1.6, "left": 0.0, "right": 0.25, "wheel": 0.0}
    assert [timer.timer_period_ns for timer in node.timers] == [10_000_000]


@pytest.mark.parametrize(
    ("parameters", "expected"),
    [
        ({"use_smallest_joint_limits": False}, {"lift": 2.0}),
        ({"zeros__left": 0.5, "zeros__lift": 1.0}, {"left": 0.5, "right": -0.25, "lift": 1.0}),
        ({"use_mimic_tags": False}, {"right": 0.0}),
        (
            {
                "zeros__left": 0.5,
                "dependent_joints__wheel__parent": "right",
                "dependent_joints__wheel__factor": 2,
            },
            {"right": -0.25, "wheel": -0.5},
        ),
        ({"dependent_joints__wheel__parent": "lift", "dependent_joints__wheel__offset": 1.0}, {"wheel": 2.6}),
        ({"delta": 0.5}, {"left": 0.5, "lift": 1.7}),
    ],
)
def test_parameters(make: Make, parameters: dict[str, Any], expected: dict[str, float]) -> None:
    found = positions(make(rate=100.0, **parameters))
    assert {name: found[name] for name in expected} == pytest.approx(expected)


def test_sources(make: Make) -> None:
    node = make(rate=100.0, source_list=["hand"], zeros__wheel=math.pi, publish_default_velocities=True)
    source = node.create_publisher(JointState, "hand", 1)
    while source.get_subscription_count() == 0:
        rclpy.spin_once(node, timeout_sec=0.1)
    state = JointState(name=["left", "right", "unknown"], position=[0.5, 9.0, 9.0], velocity=[1.0, 9.0, 9.0])
    source.publish(state)
    while positions(node)["left"] != 0.5:
        pass
    both = published(node)
    assert list(both.position) == [1.6, 0.5, -0.25, math.pi]
    assert list(both.velocity) == [0.0, 1.0, -1.0, 0.0]


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        (
            {"dependent_joints__x__parent": "left"},
            "dependent_joints.x: 'x' is a joint that the robot does not have",
        ),
        ({"dependent_joints__wheel__parent": "y"}, "'y' is a parent that the robot does not have"),
        ({"dependent_joints__left__parent": "right"}, "the joints left, right follow each other"),
        ({"rate": 0.0}, "the parameter rate must be positive, got 0.0"),
    ],
)
def test_mistakes(make: Make, parameters: dict[str, Any], message: str) -> None:
    with pytest.raises(UrdfError, match=message):
        make(**parameters)
