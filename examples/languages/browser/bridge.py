"""A bridge from WebSockets to topics, services and actions, which serves the page as well.

    make
    ifgen run bridge.py

A frame is four bytes with the length of its head, the head as JSON, and a payload: the bytes that ROS has
for a message, in both directions. Heads are padded with spaces to a multiple of 8, so that the values of a
payload are aligned in the frame.
"""

import asyncio
import json
import sys
import threading
from collections.abc import Awaitable, Callable
from contextlib import suppress
from http import HTTPStatus
from pathlib import Path
from typing import Any

import rclpy
from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.signals import SignalHandlerOptions
from rosidl_runtime_py.utilities import get_action, get_message, get_service
from rover import Rover
from websockets.asyncio.server import ServerConnection, broadcast, serve
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

WEB = Path(__file__).parent / "web"
KINDS = {".html": "text/html", ".js": "text/javascript"}
PATIENCE = 10  # seconds for a server to appear


class Page:
    """What one page asked for: its subscriptions, publishers, clients and goals."""

    def __init__(self, node: Node, socket: ServerConnection) -> None:
        self._node = node
        self._socket = socket
        self._loop = asyncio.get_running_loop()
        self._entities: dict[tuple[str, str], Any] = {}
        self._goals: dict[int, asyncio.Future[Any]] = {}

    def _send(self, head: dict[str, Any], payload: bytes = b"") -> None:
        """From any thread: executors call it too."""
        text = json.dumps(head).encode()
        text += b" " * (-len(text) % 8)
        frame = len(text).to_bytes(4, "little") + text + payload
        self._loop.call_soon_threadsafe(broadcast, [self._socket], frame)

    async def answer(self, frame: bytes) -> None:
        """Do what a frame asks for; whatever goes wrong is the answer."""
        end = 4 + int.from_bytes(frame[:4], "little")
        head = json.loads(frame[4:end])
        tasks: dict[str, Callable[..., Awaitable[None]]] = {
            "subscribe": self._subscribe,
            "publish": self._publish,
            "call": self._call,
            "goal": self._goal,
            "cancel": self._cancel,
        }
        try:
            await tasks[head["op"]](head["id"], head["name"], head["type"], frame[end:])
        except Exception as error:
            self._send({"op": "error", "id": head["id"], "message": f"{type(error).__name__}: {error}"})

    def _once(self, op: str, name: str, make: Callable[[], Any]) -> Any:
        if (op, name) not in self._entities:
            self._entities[op, name] = make()
        return self._entities[op, name]

    async def _subscribe(self, id: int, name: str, type: str, _: bytes) -> None:
        def forward(payload: bytes) -> None:
            self._send({"op": "message", "id": id}, payload)

        make = self._node.create_subscription
        self._once("subscribe", f"{name} {id}", lambda: make(get_message(type), name, forward, 10, raw=True))

    async def _publish(self, _: int, name: str, type: str, payload: bytes) -> None:
        make = self._node.create_publisher
        self._once("publish", name, lambda: make(get_message(type), name, 10)).publish(payload)

    async def _call(self, id: int, name: str, type: str, payload: bytes) -> None:
        cls = get_service(type)
        client = self._once("call", name, lambda: self._node.create_client(cls, name))
        await self._appears(client.wait_for_service, name)
        response = await self._finished(client.call_async(deserialize_message(payload, cls.Request)))
        self._send({"op": "result", "id": id}, serialize_message(response))

    async def _goal(self, id: int, name: str, type: str, payload: bytes) -> None:
        cls = get_action(type)
        client = self._once("goal", name, lambda: ActionClient(self._node, cls, name))
        await self._appears(client.wait_for_server, name)

        def feedback(message: Any) -> None:
            self._send({"op": "feedback", "id": id}, serialize_message(message.feedback))

        goal = deserialize_message(payload, cls.Goal)
        self._goals[id] = self._loop.create_future()  # it may be cancelled before it is accepted
        handle = await self._finished(client.send_goal_async(goal, feedback_callback=feedback))
        self._goals[id].set_result(handle)
        if not handle.accepted:
            raise RuntimeError(f"{name} rejected the goal")
        answer = await self._finished(handle.get_result_async())
        del self._goals[id]
        status = {GoalStatus.STATUS_SUCCEEDED: "succeeded", GoalStatus.STATUS_CANCELED: "canceled"}
        self._send(
            {"op": "result", "id": id, "status": status.get(answer.status, "aborted")},
            serialize_message(answer.result),
        )

    async def _cancel(self, id: int, *_: object) -> None:
        if id in self._goals:
            handle = await asyncio.shield(self._goals[id])
            await self._finished(handle.cancel_goal_async())

    async def _appears(self, wait: Callable[..., bool], name: str) -> None:
        if not await asyncio.to_thread(wait, timeout_sec=PATIENCE):
            raise RuntimeError(f"there is no {name}")

    async def _finished(self, future: Any) -> Any:
        """The result of a future of rclpy, which ends in a thread of the executor."""
        done = asyncio.Event()
        future.add_done_callback(lambda _: self._loop.call_soon_threadsafe(done.set))
        await done.wait()
        return future.result()

    def close(self) -> None:
        """Leave nothing behind."""
        for goal in self._goals.values():
            if goal.done():
                goal.result().cancel_goal_async()
        for (op, _), entity in self._entities.items():
            if op == "goal":
                entity.destroy()
            else:
                kind = {"subscribe": "subscription", "publish": "publisher", "call": "client"}[op]
                getattr(self._node, f"destroy_{kind}")(entity)


def file_of(connection: ServerConnection, request: Request) -> Response | None:
    """The answer to a request for a file of the page; None for a WebSocket."""
    if "Upgrade" in request.headers:
        return None
    path = WEB / ("index.html" if request.path == "/" else request.path.partition("?")[0].lstrip("/"))
    if not path.resolve().is_relative_to(WEB.resolve()) or path.suffix not in KINDS or not path.is_file():
        return connection.respond(HTTPStatus.NOT_FOUND, "not found\n")
    data = path.read_bytes()
    headers = Headers({"Content-Type": KINDS[path.suffix], "Content-Length": str(len(data))})
    return Response(HTTPStatus.OK.value, "OK", headers, data)


async def serve_pages(node: Node, port: int) -> None:
    """Serve until cancelled. Pages of other sites may not connect; programs, which have no origin, may."""

    async def talk(socket: ServerConnection) -> None:
        page, tasks = Page(node, socket), set[asyncio.Task[None]]()
        try:
            async for frame in socket:
                task = asyncio.create_task(page.answer(bytes(frame)))
                tasks.add(task)
                task.add_done_callback(tasks.discard)
        finally:
            for task in tasks:
                task.cancel()
            page.close()

    origins: list[Any] = [None]
    async with serve(talk, "127.0.0.1", port, process_request=file_of, origins=origins) as server:
        port = server.sockets[0].getsockname()[1]
        origins += [f"http://127.0.0.1:{port}", f"http://localhost:{port}"]
        print(f"http://127.0.0.1:{port}/", flush=True)
        await server.serve_forever()


def main() -> None:
    """Run the rover and the bridge; the only argument is a port."""
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)  # asyncio has its own
    executor = MultiThreadedExecutor(num_threads=4)
    node = rclpy.create_node("bridge")
    for each in (node, Rover()):
        executor.add_node(each)

    def spin() -> None:
        with suppress(ExternalShutdownException):
            executor.spin()

    thread = threading.Thread(target=spin)
    thread.start()
    try:
        asyncio.run(serve_pages(node, int(sys.argv[1]) if len(sys.argv) > 1 else 8765))
    except KeyboardInterrupt:
        print()
    finally:
        rclpy.shutdown()
        thread.join()


if __name__ == "__main__":
    main()
