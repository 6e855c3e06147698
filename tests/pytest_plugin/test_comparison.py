"""pytest's report about messages that are not equal."""

from __future__ import annotations

import pytest
from ifgen_pytest.comparison import explain

from .support import needs_rclpy

pytest_plugins = ("pytester",)

TESTS = """
from geometry_msgs.msg import Point, PoseStamped
from sensor_msgs.msg import JointState

def pose(**position):
    message = PoseStamped()
    message.header.frame_id = "map"
    message.pose.position = Point(**position)
    return message

def test_nested():
    assert pose(x=0.1, y=0.2) == pose(x=0.1, y=0.3)

def test_sequences():
    assert JointState(name=["a", "b"], position=[0.1, 0.2]) == JointState(name=["a"], position=[0.1, 0.3])

def test_list():
    assert [pose(), pose(z=0.1)] == [pose(), pose(z=1.0)]

def test_list_of_another_length():
    assert [pose()] == []

def test_many():
    assert JointState(effort=[0.1] * 99) == JointState(effort=[0.2] * 99)

def test_classes():
    assert Point() == pose()

def test_equal():
    assert pose(x=0.1) == pose(x=0.1)
"""
TOLD = """\
*assert PoseStamped == PoseStamped
*  pose.position.y: 0.2 != 0.3
*assert JointState == JointState
*  name: 2 elements != 1 element
*  position[[]1]: 0.2 != 0.3
*assert [[]PoseStamped, PoseStamped] == [[]PoseStamped, PoseStamped]
*  [[]1].pose.position.z: 0.1 != 1.0
*assert [[]PoseStamped] == [[]]
*  in all: 1 element != 0 elements
*  effort[[]3]: 0.1 != 0.2
*assert *Point(*==*PoseStamped(*"""


@pytest.mark.parametrize("transport", ["local", pytest.param("rclpy", marks=(needs_rclpy, pytest.mark.slow))])
def test_fields_that_differ(pytester: pytest.Pytester, transport: str) -> None:
    pytester.makepyfile(TESTS)
    result = pytester.runpytest_subprocess("--transport", transport, "-p", "no:randomly")
    result.assert_outcomes(passed=1, failed=6)
    result.stdout.fnmatch_lines(TOLD.splitlines())


def test_two_classes_of_one_type() -> None:
    def point(type_hash: str) -> object:
        body = {
            "__module__": "geometry_msgs.msg._point",
            "__type_hash__": type_hash,
            "get_fields_and_field_types": classmethod(lambda cls: {}),
        }
        return type("Point", (), body)()

    assert explain(point("RIHS01_a"), point("RIHS01_b")) == [
        "Point == Point",
        "these are two classes of geometry_msgs/Point, of the definitions RIHS01_a and RIHS01_b",
    ]
    assert explain(point("RIHS01_a"), point("RIHS01_a")) == [
        "Point == Point",
        "these are two classes of geometry_msgs/Point, of one definition",
    ]
