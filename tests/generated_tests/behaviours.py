"""Code as users write it in callbacks of their nodes, drawn by hypothesis and put into a generated module."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from textwrap import indent

from hypothesis import strategies as st
from ifgen.generator_py.nodes.members import members_of
from ifgen.generator_py.tests.strategies import accepted
from ifgen.generator_py.text import literal
from ifgen.nodl.model import NodeDescription

IMPORTS = """
import threading
import time

import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.parameter import Parameter
from rclpy.task import Future
from std_msgs.msg import String
"""
THREADS = "from rclpy.executors import MultiThreadedExecutor\n"
ANYWHERE = [
    'self.get_logger().info(f"{self.get_name()} is at it")',
    'self.get_logger().warning("again", throttle_duration_sec=1.0)',
    'print("printed")',
    'self.count = getattr(self, "count", 0) + 1',
    "self.seen = self.get_clock().now()",
    "age = Clock(clock_type=ClockType.STEADY_TIME).now()",
    "time.sleep(0.001)",
    "self.get_clock().sleep_for(Duration(seconds=0.001))",
    "self.create_timer(0.01, lambda: None).cancel()",
    'once = self.create_timer(0.001, lambda: (once.cancel(), print("once")))',
    "self.destroy_timer(self.create_timer(1.0, lambda: None))",
    'self.destroy_publisher(self.create_publisher(String, "~/scratch", 10))',
    'self.destroy_subscription(self.create_subscription(String, "~/scratch", print, 10))',
    'self.create_publisher(String, "~/notes", 10).publish(String(data="a note"))',
    'self.get_logger().info(f"{len(self.get_node_names())} nodes")',
    'try:\n    raise ValueError("no")\nexcept ValueError as error:\n    self.get_logger().error(str(error))',
    'threading.Thread(target=self.get_logger().info, args=("from a thread",), daemon=True).start()',
    'if not self.has_parameter("mine"):\n    self.declare_parameter("mine", 1)\n'
    'self.set_parameters([Parameter("mine", value=2)])',
    'self.create_timer(0.005, lambda: print("mine"), clock=Clock(clock_type=ClockType.STEADY_TIME))',
]
AWAITED = ["await self.sleep(0.001)"]
IN_THREADS = ["rate = self.create_rate(100.0)\nrate.sleep()\nself.destroy_rate(rate)"]
AT_START = [
    "self.add_on_set_parameters_callback(\n"
    '    lambda given: SetParametersResult(successful=given[0].name == "mine", reason="busy")\n)',
    "self.add_post_set_parameters_callback(lambda parameters: print(len(parameters)))",
    "self.add_pre_set_parameters_callback(lambda parameters: parameters)",
    "self.create_timer(0.003, self.get_name)",
]
AT_THE_END = ["raise SystemExit", "rclpy.try_shutdown()"]
WAITS_FOR_EVER = "self.arrived = Future()\nawait self.arrived"

CALLED = "self.{call}(self.{client}.srv_type.Request()).add_done_callback(lambda done: print(done.result()))"
CALLED_AND_AWAITED = "called = await self.{call}(self.{client}.srv_type.Request(), timeout_sec=5.0)"
CALLED_IN_A_TASK = """
if self.executor is not None:  # there is none while the node is made
    self.executor.create_task(self.{call}(self.{client}.srv_type.Request(), timeout_sec=5.0))
"""
WAITED_FOR = (
    'while not self.{client}.wait_for_service(timeout_sec=1.0):\n    self.get_logger().info("waiting")\n'
)
SPUN = """
done = self.{call}(self.{client}.srv_type.Request())
rclpy.spin_until_future_complete(self, done)
print(done.result())
"""
SENT = """
def told(sending):
    if sending.result().accepted:
        sending.result().get_result_async().add_done_callback(lambda ended: print(ended.result().status))

self.{send}(self.{client}._action_type.Goal(), print).add_done_callback(told)
"""
SENT_AND_AWAITED = """
goal = await self.{send}(self.{client}._action_type.Goal(), timeout_sec=5.0)
async for feedback in goal:
    print(feedback)
result = await goal.result()
"""
LIFECYCLE = {
    "on_configure": "answer = super().on_configure(state)\n{body}\nreturn answer\n",
    "on_activate": "answer = super().on_activate(state)\n{body}\nreturn answer\n",
    "on_deactivate": "{body}\nreturn super().on_deactivate(state)\n",
    "on_cleanup": "{body}\nreturn super().on_cleanup(state)\n",
}


class UserCode:
    """Statements that fit a node, drawn for one place after another."""

    def __init__(self, node: NodeDescription, draw: st.DrawFn, in_threads: bool) -> None:
        self._node = node
        self._draw = draw
        self._members = members_of(node)
        self._is_async = node.style == "asyncio"
        self._in_threads = [*IN_THREADS] if in_threads else []

    def callback(self) -> str:
        """The beginning of a callback."""
        fitting = [*ANYWHERE, *self._in_threads, *self._of_entities(self._is_async), *self._of_parameters()]
        return self._some([*fitting, *AWAITED] if self._is_async else fitting)

    def after_a_change(self) -> str:
        """The callback after a change of parameters: it changes none itself, and waits for nothing."""
        return self._some([*ANYWHERE, *self._in_threads, *self._of_entities(False)])

    def end(self, own: str) -> str:
        """The end of the callback of a subscription or a timer; the statement `own` ends that entity."""
        ends = [own, *AT_THE_END, *([WAITS_FOR_EVER] if self._is_async else [])]
        return self._draw(st.sampled_from(["", "", *ends]))

    def constructor(self) -> str:
        """The rest of the constructor: a managed node has no entities yet."""
        if self._node.style == "lifecycle":
            return self._some([*ANYWHERE, *AT_START])
        starting = [*ANYWHERE, *AT_START, *self._of_clients({"call": [WAITED_FOR]})]
        if self._node.style == "callbacks":
            starting += self._of_clients({"call": [SPUN]})
        return self._some([*starting, *self._of_entities(False), *self._of_parameters()])

    def _some(self, statements: list[str]) -> str:
        chosen = self._draw(st.lists(st.sampled_from(statements), min_size=1, max_size=5, unique=True))
        return "\n".join(chosen)

    def _of_entities(self, awaits: bool) -> Iterator[str]:
        node, members = self._node, self._members
        for publisher in node.publishers:
            found = members.of(publisher)
            yield f"self.{found.methods[0]}(self.{found.attribute}.msg_type())"
        if awaits:
            yield from self._of_clients({"call": [CALLED_AND_AWAITED], "send": [SENT_AND_AWAITED]})
        elif self._is_async:
            yield from self._of_clients({"call": [CALLED_IN_A_TASK]})
        else:
            yield from self._of_clients({"call": [CALLED, WAITED_FOR], "send": [SENT]})
        for timer in members.timers:
            yield from (f"self.{timer.attribute}.cancel()", f"self.{timer.attribute}.reset()")

    def _of_parameters(self) -> Iterator[str]:
        for parameter in self._node.parameters:
            for value in accepted(parameter)[:2]:
                if not parameter.read_only and value not in ((), b""):
                    yield f"self.set_parameters([Parameter({parameter.name!r}, value={literal(value)})])"

    def _of_clients(self, texts: dict[str, list[str]]) -> Iterator[str]:
        clients = [("call", client) for client in self._node.service_clients]
        clients += [("send", client) for client in self._node.action_clients]
        for verb, client in clients:
            found = self._members.of(client)
            for text in texts.get(verb, ()):
                yield text.format(**{verb: found.methods[0]}, client=found.attribute)


@st.composite
def ordinary(draw: st.DrawFn, node: NodeDescription, module: str) -> str:
    """The user's module of a node as it was generated, with code in each callback."""
    in_threads = "MultiThreadedExecutor" in module or (node.style == "callbacks" and draw(st.booleans()))
    code = UserCode(node, draw, in_threads)
    members = members_of(node)
    ends = {
        members.of(found).methods[0]: f"self.destroy_subscription(self.{members.of(found).attribute})"
        for found in node.subscriptions
    }
    ends |= {timer.method: f"self.destroy_timer(self.{timer.attribute})" for timer in members.timers}
    lines = module.splitlines()
    [found] = [item for item in ast.parse(module).body if isinstance(item, ast.ClassDef)]
    methods = [item for item in found.body if isinstance(item, ast.FunctionDef | ast.AsyncFunctionDef)]
    written = {method.name for method in methods}
    own = [(name, body) for name, body in _methods_of_users(node, code).items() if name not in written]
    lines[found.end_lineno : found.end_lineno] = "\n".join(map(_method, *zip(*own, strict=True))).splitlines()
    for method in reversed(methods):
        last = method.end_lineno or 0
        if method.name in ends:
            lines[last:last] = indent(code.end(ends[method.name]), " " * 8).splitlines()
        if method.name == "__init__":
            lines[last:last] = indent(code.constructor(), " " * 8).splitlines()
        elif not method.name.startswith(("on_activate", "cancel_")):
            begin = method.body[1].lineno - 1  # after the docstring
            lines[begin:begin] = indent(code.callback(), " " * 8).splitlines()
    future = "from __future__ import annotations\n"
    text = "\n".join(lines) + "\n"
    return text.replace(future, future + IMPORTS + (THREADS if in_threads else ""), 1)


def _methods_of_users(node: NodeDescription, code: UserCode) -> dict[str, str]:
    """Optional methods of a node."""
    found = {"on_parameters_changed": code.after_a_change()} if node.parameters else {}
    if node.style == "lifecycle":
        found |= {name: text.format(body=code.callback()) for name, text in LIFECYCLE.items()}
    return found or {"helper": "pass"}


def _method(name: str, body: str) -> str:
    arguments = {"on_parameters_changed": "self, parameters", "helper": "self"}.get(name, "self, state")
    return f"\n    def {name}({arguments}):\n{indent(body, ' ' * 8)}"
