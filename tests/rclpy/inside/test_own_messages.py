"""Messages that rclpy makes itself hold every text of a program, and parameters change all or not at all."""

from __future__ import annotations

import io
import sys
from collections.abc import Iterator
from typing import Any

import pytest
import rclpy
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from ifgen_runtime import SerializationError, serialize
from rcl_interfaces.msg import IntegerRange, Log, ParameterDescriptor, ParameterEvent, SetParametersResult
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.messages import cleaned_text
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import String

TEXTS = st.text(st.characters(exclude_categories=()), max_size=20) | st.binary(max_size=20).map(
    lambda data: data.decode("utf-8", "surrogateescape")
)
TOO_LARGE = 2**63


class Gps:
    """A node with parameters, and another one that hears and asks what it publishes and answers."""

    def __init__(self) -> None:
        self.node, self.other = Node("gps"), Node("monitor")
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.executor.add_node(self.other)
        self.heard: list[Any] = []
        for kind, topic in ((Log, "/rosout"), (ParameterEvent, "/parameter_events")):
            self.other.create_subscription(kind, topic, self.heard.append, 100)

    def next(self, kind: type[Any]) -> Any:
        for _ in range(100):
            self.executor.spin_once(timeout_sec=0.1)
            while self.heard:
                message = self.heard.pop(0)
                if isinstance(message, kind):
                    return message
        raise AssertionError("nothing came")

    def ask(self, service: Any, name: str, **request: Any) -> Any:
        client = self.other.create_client(service, f"/gps/{name}")
        future = client.call_async(service.Request(**request))
        self.executor.spin_until_future_complete(future, 10.0)
        self.other.destroy_client(client)
        return future.result()


@pytest.fixture
def gps() -> Iterator[Gps]:
    rclpy.init()
    yield Gps()
    rclpy.shutdown()


SEVERAL = settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture], database=None
)


@given(TEXTS)
@settings(deadline=None, database=None)
def test_a_clean_text_fits_and_a_sound_one_stays(text: str) -> None:
    clean = cleaned_text(text)
    serialize(String(data=clean))
    if "\0" not in text and not any("\ud800" <= each <= "\udfff" for each in text):
        assert clean == text


@SEVERAL
@given(TEXTS)
@example("cannot parse $GPGGA,1\0\0")
@example(b"caf\xe9".decode("utf-8", "surrogateescape"))
@example("x" * 100_000)
def test_logs(gps: Gps, text: str) -> None:
    gps.heard.clear()
    assert gps.node.get_logger().warning(text)
    assert gps.next(Log).msg == cleaned_text(text)
    if text:
        child = gps.node.get_logger().get_child(text)
        assert child.warning("fix")
        assert gps.next(Log).name == cleaned_text(f"gps.{text}")
    code = compile("node.get_logger().info('here')", f"/tmp/{text.replace(chr(0), '')}/gps.py", "exec")
    exec(code, {"node": gps.node})
    assert gps.next(Log).file.endswith("/gps.py")


@SEVERAL
@given(TEXTS)
@example("x\0y")
@example("\ud800")
def test_parameters(gps: Gps, text: str) -> None:
    node, clean = gps.node, cleaned_text(text)
    gps.heard.clear()
    descriptor = ParameterDescriptor(description=text, additional_constraints=text)
    node.declare_parameter("port", text, descriptor)
    (parameter,) = gps.next(ParameterEvent).new_parameters
    assert parameter.value.string_value == clean
    assert node.get_parameter("port").value == text
    assert (
        gps.ask(DescribeParameters, "describe_parameters", names=["port"]).descriptors[0].description == clean
    )
    assert gps.ask(GetParameters, "get_parameters", names=["port"]).values[0].string_value == clean
    (result,) = node.set_parameters([Parameter("port", value=text + "!")])
    assert result.successful
    gps.next(ParameterEvent)
    refuse = lambda _: SetParametersResult(successful=False, reason=text)  # noqa: E731
    node.add_on_set_parameters_callback(refuse)
    request = [Parameter("port", value="other").to_parameter_msg()]
    assert gps.ask(SetParameters, "set_parameters", parameters=request).results[0].reason == clean
    node.remove_on_set_parameters_callback(refuse)
    node.undeclare_parameter("port")
    node.declare_parameter(f"p{text}", [text])
    (parameter,) = gps.next(ParameterEvent).new_parameters
    assert (parameter.name, list(parameter.value.string_array_value)) == (cleaned_text(f"p{text}"), [clean])
    names = gps.ask(ListParameters, "list_parameters").result.names
    assert cleaned_text(f"p{text}") in names
    node.undeclare_parameter(f"p{text}")


def _state(node: Node) -> Any:
    parameters = {name: parameter.value for name, parameter in node._parameters.items()}
    return parameters, {name: (d.type, d.read_only) for name, d in node._descriptors.items()}


CHANGES: dict[str, Any] = {
    "declare": lambda node: node.declare_parameter("new", TOO_LARGE),
    "declare several": lambda node: node.declare_parameters("", [("new", 1), ("newer", TOO_LARGE)]),
    "a descriptor": lambda node: node.declare_parameters(
        "", [("new", 1), ("newer", 2, _descriptor_that_does_not_fit())]
    ),
    "set": lambda node: node.set_parameters([Parameter("a", value=2), Parameter("b", value=TOO_LARGE)]),
    "atomically": lambda node: node.set_parameters_atomically(
        [Parameter("a", value=2), Parameter("b", value=TOO_LARGE)]
    ),
    "an array": lambda node: node.set_parameters_atomically([Parameter("any", value=[1, TOO_LARGE])]),
}


def _descriptor_that_does_not_fit() -> ParameterDescriptor:
    descriptor = ParameterDescriptor()
    descriptor.type = 1
    descriptor.integer_range = [IntegerRange(to_value=TOO_LARGE)]
    return descriptor


@pytest.mark.parametrize("change", CHANGES)
def test_what_no_message_can_hold_changes_nothing(gps: Gps, change: str) -> None:
    node = gps.node
    node.declare_parameters("", [("a", 1), ("b", 1), ("any", "x", ParameterDescriptor(dynamic_typing=True))])
    before = _state(node)
    with pytest.raises((SerializationError, OverflowError), match=r"expected an integer in|too big"):
        CHANGES[change](node)
    assert _state(node) == before


def test_a_refused_value_leaves_the_type_as_it_was(gps: Gps) -> None:
    node = gps.node
    node.declare_parameter("any", "x", ParameterDescriptor(dynamic_typing=True))
    node.add_on_set_parameters_callback(lambda _: SetParametersResult(successful=False))
    before = _state(node)
    assert not node.set_parameters([Parameter("any", value=1)])[0].successful
    assert _state(node) == before


def test_a_change_that_cannot_be_published_is_none(gps: Gps, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(_: Any) -> None:
        raise RuntimeError("no memory")

    before = _state(gps.node)
    monkeypatch.setattr(gps.node._parameter_event_publisher, "publish", fail)
    with pytest.raises(RuntimeError, match="no memory"):
        gps.node.declare_parameter("new", 1)
    assert _state(gps.node) == before


def test_a_stream_in_ascii_takes_every_log(gps: Gps, monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    monkeypatch.setattr(sys, "stderr", stream)
    gps.node.get_logger().info("café")
    stream.flush()
    assert stream.buffer.getvalue().endswith(b"caf\\xe9\n")


def test_a_node_of_the_same_name_after_a_shutdown_logs_as_the_first_did(
    capfd: pytest.CaptureFixture[str],
) -> None:
    rclpy.init()
    first = Node("gps")  # still there when the second one comes
    rclpy.shutdown()
    rclpy.init()
    again = Gps()
    first.destroy_node()
    again.node.get_logger().info("fix")
    assert again.next(Log).msg == "fix"
    assert "already registered" not in capfd.readouterr().err
    rclpy.shutdown()


def test_a_message_stands_for_its_class(gps: Gps) -> None:
    words: list[str] = []
    kind: Any = String()
    gps.other.create_subscription(kind, "word", lambda message: words.append(message.data), 1)
    publisher = gps.node.create_publisher(kind, "word", 1)
    publisher.publish(String(data="here"))
    for _ in range(100):
        if words:
            break
        gps.executor.spin_once(timeout_sec=0.1)
    assert words == ["here"]
    assert publisher.msg_type is String
