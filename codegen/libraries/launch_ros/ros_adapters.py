# Values that users write are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""The node of a launch, for transitions of managed nodes, for containers and for the clock."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Sequence
from typing import Any, Final

import rclpy
from launch.launch_context import LaunchContext
from launch.logging import get_logger
from lifecycle_msgs.msg import TransitionEvent
from lifecycle_msgs.srv import ChangeState
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node

_STEP: Final = 0.2  # [s] between looks whether the launch is over
_HISTORY: Final = 10


class ROSAdapter:
    """A hidden node that spins in a thread. `post` makes calls in the thread of the launch."""

    def __init__(self, post: Callable[[Callable[[], None]], None], argv: Sequence[str] = ()) -> None:
        self._post = post
        self._context = Context()
        rclpy.init(args=list(argv), context=self._context)
        name = f"_launch_{os.getpid()}"
        self._node = rclpy.create_node(
            name, context=self._context, start_parameter_services=False, enable_rosout=False
        )
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._lock = threading.Lock()
        self._clients: dict[str, Any] = {}
        self._is_closed = threading.Event()
        self._changes: list[threading.Thread] = []
        self._thread = threading.Thread(target=self._spin, daemon=True)
        self._thread.start()

    @property
    def ros_node(self) -> Node:
        """The node."""
        return self._node

    @property
    def ros_context(self) -> Context:
        """The context of the node."""
        return self._context

    @property
    def ros_executor(self) -> SingleThreadedExecutor:
        """The executor that spins the node, in a thread of its own."""
        return self._executor

    def watch(self, node_name: str, call: Callable[[Any], None]) -> None:
        """Call with each transition of a node."""

        def come(message: Any) -> None:
            self._post(lambda: call(message))

        topic = f"{node_name}/transition_event"
        self._node.create_subscription(TransitionEvent, topic, come, _HISTORY)

    def change(self, node_name: str, transition_id: int) -> None:
        """Ask a node for a transition, as soon as it is there."""
        self.work(lambda: self._change(node_name, transition_id))

    def work(self, call: Callable[[], None]) -> None:
        """Make a call in a thread of its own, which looks at `is_closed` while it waits."""
        thread = threading.Thread(target=call, daemon=True)
        self._changes.append(thread)
        thread.start()

    def call(self, client: Any, request: Any, is_ready: Callable[[], bool]) -> Any:
        """Wait for a server, and until it is ready, and return its answer; None if the launch ends before."""
        while not (client.wait_for_service(timeout_sec=_STEP) and is_ready()):
            if self._is_closed.wait(0.01):
                return None
        answered = threading.Event()
        future = client.call_async(request)
        future.add_done_callback(lambda _: answered.set())
        while not answered.wait(_STEP):
            if self._is_closed.is_set():
                return None
        return future.result()

    def close(self) -> None:
        """Leave the graph."""
        self._is_closed.set()
        for change in self._changes:
            change.join(1.0)  # they use the node
        self._executor.shutdown(timeout_sec=1.0)
        self._node.destroy_node()
        rclpy.shutdown(context=self._context)
        self._thread.join(1.0)

    def _spin(self) -> None:
        try:
            self._executor.spin()
        except ExternalShutdownException:
            return

    def _change(self, node_name: str, transition_id: int) -> None:
        name = f"{node_name}/change_state"
        with self._lock:
            client = self._clients.get(name) or self._node.create_client(ChangeState, name)
            self._clients[name] = client
        topic = f"{node_name}/transition_event"
        # Its publisher, too: a transition before that is known would not be heard.
        result = self.call(client, _request(transition_id), lambda: bool(self._node.count_publishers(topic)))
        if result is not None and not result.success:
            text = f"Failed to make transition '{transition_id}' for LifecycleNode '{node_name}'"
            self._post(lambda: get_logger("launch_ros.actions.lifecycle_node").error(text))


def _request(transition_id: int) -> ChangeState.Request:
    request = ChangeState.Request()
    request.transition.id = transition_id
    return request


def get_ros_adapter(context: LaunchContext) -> ROSAdapter:
    """Return the node of a launch, with its thread; made when somebody asks."""
    adapter: ROSAdapter | None = context.get_globals_as_dict().get("ros_adapter")
    if adapter is None:
        adapter = ROSAdapter(context.host.post)
        context.extend_globals({"ros_adapter": adapter})
        context.host.at_end(adapter.close)
    return adapter


def get_ros_node(context: LaunchContext) -> Node:
    """Return the node of a launch."""
    return get_ros_adapter(context).ros_node
