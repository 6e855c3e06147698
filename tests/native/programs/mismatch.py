"""Two processes with two versions of the same types: `mismatch.py mine|other POLICY jazzy|kilted`.

`mine` prints as JSON what it hears, receives and answers. It goes on once it has seen some messages of a type that
both share, after it has heard of all that they do not. Then `other` destroys its publisher with the other version,
and one with the version of `mine` goes on.
"""

import json
import os
import sys
import time

import ifgen.dynamic
from common import rclpy
from ifgen_runtime.adapters import Adapter, register
from ifgen_runtime.mismatch import reporting
from rcl_interfaces.msg import Log
from rclpy.action import ActionClient, ActionServer
from rclpy.event_handler import SubscriptionEventCallbacks

LIMIT = 40.0  # [s]
# [s] without an answer before an adapted service is asked again: on a busy machine, DDS may lose the response to a
# client that is said to be ready.
PATIENCE = 5.0
TICKS = 20
OURS, THEIRS = 0, 1


def versions(name, *texts, points=("float64 x\nfloat64 y", "float64 y\nfloat64 x")):
    """The classes of two texts, which may contain a Point: its fields change places."""
    return [
        ifgen.dynamic.class_from_text(f"my_msgs/{name}", text, others={"my_msgs/msg/Point": point})
        for text, point in zip(texts, points, strict=True)
    ]


SPEED = "float64 a\nPoint p"
SPEEDS = versions("msg/Speed", SPEED, SPEED)
ADDS = versions(
    "srv/Add",
    "float64 a\nfloat64 b\n---\nfloat64 sum\nbool ok",
    "float64 b\nfloat64 a\nint32 c\n---\nbool ok\nfloat64 sum",
)
GOES = versions(
    "action/Go",
    "float64 a\n---\nfloat64 b\n---\nfloat64 c",
    "float64 a\n---\nfloat64 b\n---\nint32 n\nfloat64 c",
)
Tick = ifgen.dynamic.class_from_text("my_msgs/msg/Tick", "bool with_both")


def speed(version):
    made = SPEEDS[version](a=0.1)
    made.p.x, made.p.y = 0.2, 0.3
    return made


def adapt() -> None:
    ours, theirs = SPEEDS

    def upgrade(old):
        new = ours(a=old.a)
        new.p.x, new.p.y = old.p.x, old.p.y
        return new

    register(Adapter(theirs, ours, upgrade))
    for part, names in (("Request", ("a", "b")), ("Response", ("sum", "ok"))):
        our_part, their_part = (getattr(add, part) for add in ADDS)
        register(
            Adapter(
                their_part,
                our_part,
                lambda old, new=our_part, names=names: new(**{name: getattr(old, name) for name in names}),
                lambda new, old=their_part, names=names: old(**{name: getattr(new, name) for name in names}),
            )
        )


class Question:
    """One request, asked again if it is to be adapted and nobody answers."""

    def __init__(self, client, request) -> None:
        self._client, self._request = client, request
        self._since, self.future = 0.0, None

    def ask(self) -> None:
        """Ask, where it is time to."""
        lost = policy == "adapt" and time.monotonic() - self._since > PATIENCE
        if self.future is None or (lost and not self.future.done()):
            self.future, self._since = self._client.call_async(self._request), time.monotonic()

    def answer(self):
        """The response, or None."""
        return self.future.result() if self.future is not None and self.future.done() else None


def serve(node, version, name, requests) -> None:
    Add = ADDS[version]

    def add(request, response):
        if [request.a, request.b] not in requests:
            requests.append([request.a, request.b])
        response.sum, response.ok = request.a + request.b, True
        return response

    node.create_service(Add, name, add)


def serve_goals(node, version, name, goals):
    Go = GOES[version]

    def go(goal):
        goals.append(goal.request.a)
        goal.succeed()
        return Go.Result(b=0.5)

    return ActionServer(node, Go, name, go)


def mine() -> None:
    began = time.monotonic()
    heard, received, requests, events = [], [], [], []
    ticks, tick_times = [], []

    def hear(mismatch) -> None:
        theirs = mismatch.theirs
        found = [mismatch.kind, mismatch.name, mismatch.policy, mismatch.type_name]
        heard.append(
            [*found, mismatch.mine.node, theirs.node, theirs.definition is not None, time.monotonic()]
        )

    reporting.listener = hear
    rclpy.init(args=["--ros-args", "-r", "speed_in:=/speed"])
    node = rclpy.create_node("mine", namespace="/robot")
    node.create_subscription(
        SPEEDS[OURS],
        "speed_in",
        lambda message: received.append([message.a, message.p.x, message.p.y]),
        10,
        event_callbacks=SubscriptionEventCallbacks(
            incompatible_type=lambda event: events.append([event.total_count, event.total_count_change])
        ),
    )

    def note_tick(message) -> None:
        ticks.append(message)
        tick_times.append(time.monotonic())

    node.create_subscription(Tick, "/tick", note_tick, 10)
    said = []
    node.create_subscription(
        Log, "/rosout", lambda log: said.append(log) if "left over" in log.msg else None, 10
    )
    go_on = node.create_publisher(Tick, "/go_on", 10)
    serve(node, OURS, "/serve", requests)
    client = node.create_client(ADDS[OURS], "/ask")
    goals = []
    server = serve_goals(node, OURS, "/go", goals)
    action = ActionClient(node, GOES[OURS], "/walk")

    question = Question(client, ADDS[OURS].Request(a=0.1, b=0.2))
    asks = policy == "adapt" and distribution == "jazzy"  # Kilted connects no such services
    seen_before = None

    def have_heard() -> bool:
        nonlocal seen_before
        if client.service_is_ready():
            question.ask()
        if policy == "warn" and distribution == "jazzy" and not (said and goals):
            return False
        if len(heard) < 5 or (asks and not (question.answer() and requests)):
            return False
        if seen_before is None:
            seen_before = len(ticks)
        return len(ticks) - seen_before >= TICKS

    def spin_until(holds) -> bool:
        while not holds() and time.monotonic() < began + LIMIT:
            rclpy.spin_once(node, timeout_sec=0.02)
        return bool(holds())

    complete = spin_until(have_heard)
    received_before = list(received)
    go_on.publish(Tick())
    spin_until(lambda: ticks and not ticks[-1].with_both)
    received.clear()
    left = spin_until(lambda: len(received) >= 5)
    met = min([*tick_times, time.monotonic()])
    response = question.answer()
    print(
        json.dumps(
            {
                "complete": [complete, left],
                "heard": [[*found[:-1], round(found[-1] - met, 3)] for found in heard],
                "received": received_before,
                "later": received,
                "requests": requests,
                "response": response and [response.sum, response.ok],
                "events": events,
                "goals": goals,
                "walk_is_ready": action.server_is_ready(),
            }
        )
    )
    action.destroy()
    server.destroy()
    node.destroy_node()
    rclpy.shutdown()


def other() -> None:
    rclpy.init()
    node, twin = rclpy.create_node("other"), rclpy.create_node("twin")
    # Jazzy's rclpy does not tell whose a message is, so a topic of both definitions is not adapted.
    alone = policy == "adapt" and distribution == "jazzy"
    agreeing = None if alone else twin.create_publisher(SPEEDS[OURS], "/speed", 10)  # as `mine` has it
    publisher = node.create_publisher(SPEEDS[THEIRS], "/speed", 10)
    tick = node.create_publisher(Tick, "/tick", 10)
    serve(node, THEIRS, "/ask", [])
    server = serve_goals(node, THEIRS, "/walk", [])
    client = node.create_client(ADDS[THEIRS], "/serve")
    action = ActionClient(node, GOES[THEIRS], "/go")
    question = Question(client, ADDS[THEIRS].Request(a=0.1, b=0.2))

    def stop(message) -> None:
        nonlocal agreeing, publisher
        if publisher is not None:
            node.destroy_publisher(publisher)
            publisher = None
            agreeing = agreeing or twin.create_publisher(SPEEDS[OURS], "/speed", 10)

    def publish() -> None:
        if publisher is not None:
            publisher.publish(speed(THEIRS))
        if agreeing is not None:
            agreeing.publish(speed(OURS))
        tick.publish(Tick(with_both=publisher is not None))
        if client.service_is_ready() and action.server_is_ready():
            if question.future is None:
                action.send_goal_async(GOES[THEIRS].Goal(a=0.7))
            question.ask()

    node.create_subscription(Tick, "/go_on", stop, 10)
    node.create_timer(0.02, publish)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
        action.destroy()
        server.destroy()


if __name__ == "__main__":
    role, policy, distribution = sys.argv[1:]
    os.environ["IFGEN_ON_TYPE_MISMATCH"] = policy if role == "mine" else "warn"
    if policy == "adapt" and role == "mine":
        adapt()
    {"mine": mine, "other": other}[role]()
