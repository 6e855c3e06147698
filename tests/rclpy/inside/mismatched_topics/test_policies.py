"""Which policy a node has for definitions that differ."""

from __future__ import annotations

import pytest
from rclpy.node import Node
from rclpy.parameter import Parameter

from tests.rclpy.inside.mismatched_topics.speeds import Longer, Message, New, node, spin


def test_a_class_attribute_and_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    class Refusing(Node):
        on_type_mismatch = "refuse"

    monkeypatch.setenv("IFGEN_ON_TYPE_MISMATCH", "adapt")
    override = [Parameter("on_type_mismatch", value="warn")]
    policies = [
        each.handle.graph_node.on_type_mismatch
        for each in (node("plain"), Refusing("class"), Refusing("override", parameter_overrides=override))
    ]
    assert policies == ["adapt", "refuse", "warn"]


def test_a_policy_on_the_command_line() -> None:
    chosen = node("n", cli_args=["--ros-args", "-p", "on_type_mismatch:=refuse"])
    assert chosen.handle.graph_node.on_type_mismatch == "refuse"


def test_a_policy_that_does_not_exist_is_refused() -> None:
    with pytest.raises(
        ValueError, match="parameter on_type_mismatch is 'stop', expected one of warn, refuse, adapt"
    ):
        node("n", "stop")


def test_a_declared_parameter_counts_for_endpoints_that_meet_from_then_on() -> None:
    receiver, got = node("receiver"), list[Message]()
    receiver.create_subscription(New, "before", got.append, 10)
    node("old").create_publisher(Longer, "before", 10).publish(Longer())
    receiver.declare_parameter("on_type_mismatch", "warn")
    (result,) = receiver.set_parameters([Parameter("on_type_mismatch", value="stop")])
    assert not result.successful
    assert "expected one of warn, refuse, adapt" in result.reason
    (result,) = receiver.set_parameters([Parameter("on_type_mismatch", value="refuse")])
    assert result.successful
    receiver.create_subscription(New, "after", lambda _: pytest.fail("refused"), 10)
    node("older").create_publisher(Longer, "after", 10).publish(Longer())
    spin(receiver)
    assert len(got) == 1
    receiver.undeclare_parameter("on_type_mismatch")
    assert receiver.handle.graph_node.on_type_mismatch == "warn"
