"""The node of a launch, which asks managed nodes for transitions and hears of those that they make."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from typing import Any, Final

import rclpy
from lifecycle_msgs.msg import TransitionEvent
from lifecycle_msgs.srv import ChangeState
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor

_STEP: Final = 0.2  # [s] between looks whether the launch is over
_HISTORY: Final = 10


class Lifecycle:
    """A hidden node that spins in a thread. `post` makes calls in the thread of the launch."""

    def __init__(
        self, post: Callable[[Callable[[], None]], None], log: Callable[[str, str, str], None]
    ) -> None:
        self._post = post
        self._log = log
        self._context = Context()
        rclpy.init(args=[], context=self._context)
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

    def watch(self, node_name: str, call: Callable[[Any], None]) -> None:
        """Call with each transition of a node."""

        def come(message: Any) -> None:
            self._post(lambda: call(message))

        topic = f"{node_name}/transition_event"
        self._node.create_subscription(TransitionEvent, topic, come, _HISTORY)

    def change(self, node_name: str, transition_id: int) -> None:
        """Ask a node for a transition, as soon as it is there."""
        change = threading.Thread(target=self._change, args=(node_name, transition_id), daemon=True)
        self._changes.append(change)
        change.start()

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
        while not (client.wait_for_service(timeout_sec=_STEP) and self._node.count_publishers(topic)):
            if self._is_closed.wait(0.01):
                return
        answered = threading.Event()
        future = client.call_async(_request(transition_id))
        future.add_done_callback(lambda _: answered.set())
        while not answered.wait(_STEP):
            if self._is_closed.is_set():
                return
        result: Any = future.result()
        if result is None or not result.success:
            text = f"Failed to make transition '{transition_id}' for LifecycleNode '{node_name}'"
            self._post(lambda: self._log("ERROR", "launch_ros.actions.lifecycle_node", text))


def _request(transition_id: int) -> ChangeState.Request:
    request = ChangeState.Request()
    request.transition.id = transition_id
    return request
