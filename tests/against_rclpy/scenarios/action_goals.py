"""One server and one client: how goals are accepted, executed and finished, and their feedback and status."""

import rclpy
from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import QoSProfile
from rclpy.task import Future
from test_msgs.action import Fibonacci
from transcript import attempt, refused, until
from unique_identifier_msgs.msg import UUID


def result(*numbers):
    return Fibonacci.Result(sequence=list(numbers))


class Scene:
    """A server whose callbacks change from case to case, and a client, in one executor."""

    def __init__(self):
        self.node = rclpy.create_node("actor", namespace="/stage")
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.server = ActionServer(self.node, Fibonacci, "fib", lambda handle: result())
        self.client = ActionClient(self.node, Fibonacci, "fib")
        self.number = 0
        attempt("server there", lambda: self.client.wait_for_server(timeout_sec=10.0))

    def next_id(self):
        self.number += 1
        return UUID(uuid=[self.number] * 16)

    def send(self, goal_id=None, feedback=None, order=5):
        future = self.client.send_goal_async(Fibonacci.Goal(order=order), feedback, goal_id or self.next_id())
        until(future.done, self.executor)
        return future.result()

    def finish(self, handle):
        future = handle.get_result_async()
        until(future.done, self.executor)
        return future.result()

    def play(self, label, execute):
        """Run one goal with this execute callback; print how it ended."""
        self.server.register_execute_callback(execute)
        handle = self.send()
        ended = self.finish(handle)
        # Status and result arrive in different ways.
        until(lambda: handle.status == ended.status, self.executor)
        print(
            f"{label}: accepted {handle.accepted}, {ended.status}, {ended.result.sequence}, {handle.status}"
        )
        return handle


def answers(scene):
    """The answers that a goal callback may return."""

    def goal_callback(goal):
        print("asked", type(goal).__name__, goal.order)
        return answer

    scene.server.register_goal_callback(goal_callback)
    for answer in (GoalResponse.ACCEPT, GoalResponse.REJECT, True, None, 2, CancelResponse.ACCEPT):
        handle = scene.send()
        print(f"{answer}: accepted {handle.accepted}, stamped {handle.stamp.sec > 0}, status {handle.status}")

    async def slowly(goal):
        print("coroutine asked")
        return GoalResponse.REJECT

    scene.server.register_goal_callback(slowly)
    print("coroutine", scene.send().accepted)
    scene.server.register_goal_callback(None)
    print("unregistered", scene.send().accepted)


def endings(scene):
    """The ways in which an execute callback may end."""

    def succeeds(handle):
        print("request", handle.request.order, handle.is_active, handle.is_cancel_requested, handle.status)
        handle.succeed()
        print("after", handle.is_active, handle.status)
        return result(1, 1, 2)

    def aborts(handle):
        handle.abort()
        return result(7)

    def forgets(handle):
        return result(8)

    def raises(handle):
        raise ValueError("boom")

    def raises_late(handle):
        handle.succeed()
        raise ValueError("late")

    def twice(handle):
        attempt("canceled", handle.canceled)
        handle.succeed()
        attempt("again", handle.succeed)
        attempt("abort", handle.abort)
        attempt("execute", handle.execute)
        return result(9)

    def wrong_feedback(handle):
        refused("feedback", lambda: handle.publish_feedback(Fibonacci.Result()))
        refused("feedback", lambda: handle.publish_feedback(None))
        handle.succeed()
        return result()

    async def awaits(handle):
        print("future", await future)
        handle.succeed()
        return result(4)

    for execute in (succeeds, aborts, forgets, raises, raises_late, twice, wrong_feedback):
        scene.play(execute.__name__, execute)

    future = Future()
    scene.server.register_execute_callback(awaits)
    handle = scene.send()
    until(lambda: handle.status == GoalStatus.STATUS_EXECUTING, scene.executor)
    print("awaits: executing", handle.status)
    future.set_result("set")
    ended = scene.finish(handle)
    print("awaits:", ended.status, ended.result.sequence)
    print("asked again:", scene.finish(handle).result.sequence)

    attempt("register", lambda: scene.server.register_execute_callback(None))


def destroyed_handle(scene):
    """A server that destroys a goal's handle forgets the goal; the client still gets the result."""

    def execute(handle):
        handle.destroy()
        print("destroyed", handle.status, handle.is_active, handle.is_cancel_requested)
        attempt("succeed", handle.succeed)
        attempt("feedback", lambda: handle.publish_feedback(Fibonacci.Feedback()))
        attempt("destroy", handle.destroy)
        return result(3)

    scene.server.register_execute_callback(execute)
    ended = scene.finish(scene.send())
    print(ended.status, ended.result.sequence)


def feedback(scene):
    """Feedback goes to the goal that it is about."""
    heard = []
    own = scene.next_id()

    def execute(handle):
        for count in range(4):
            handle.publish_feedback(Fibonacci.Feedback(sequence=[count]))
        handle.succeed()
        return result()

    scene.server.register_execute_callback(execute)
    handle = scene.send(
        own, lambda message: heard.append((message.goal_id == own, list(message.feedback.sequence)))
    )
    until(lambda: len(heard) == 4, scene.executor)
    print("heard", heard)
    print("type", handle.goal_id == own, handle.status in (2, 4))
    scene.finish(handle)

    async def listen(message):
        heard.append(type(message).__name__)

    del heard[:]
    handle = scene.send(None, listen)
    until(lambda: len(heard) == 4, scene.executor)
    print("coroutine heard", heard)
    scene.finish(handle)
    scene.finish(scene.send())
    print("nobody listens", len(heard))


def deferred(scene):
    """Goals wait until somebody executes them, in any order, also with a callback of their own."""
    waiting = []
    executed = []
    scene.server.register_handle_accepted_callback(waiting.append)

    def execute(handle):
        executed.append(int(handle.goal_id.uuid[0]))
        handle.succeed()
        return result(handle.request.order)

    scene.server.register_execute_callback(execute)
    first, second, third = (scene.send(order=order) for order in (11, 12, 13))
    until(lambda: third.status == GoalStatus.STATUS_ACCEPTED, scene.executor)
    print("waiting", len(waiting), [each.status for each in (first, second, third)])
    attempt("equal", lambda: (waiting[0] == waiting[0], waiting[0] == waiting[1], waiting[0] != waiting[1]))
    attempt("hash", lambda: hash(waiting[0]))
    waiting[2].execute()
    print("third", scene.finish(third).result.sequence)
    waiting[0].execute(lambda handle: (handle.abort(), result(0))[1])
    ended = scene.finish(first)
    print("first", ended.status, ended.result.sequence)
    waiting[1].execute()
    print("second", scene.finish(second).status, "order", [number - executed[0] for number in executed])
    attempt("executed already", waiting[1].execute)
    scene.server.register_handle_accepted_callback(None)


def duplicates(scene):
    """An id that the server knows is rejected without asking."""
    scene.server.register_execute_callback(lambda handle: (handle.succeed(), result())[1])
    goal_id = scene.next_id()
    print("first", scene.send(goal_id).accepted)
    scene.server.register_goal_callback(lambda goal: print("asked") or GoalResponse.ACCEPT)
    print("same", scene.send(goal_id).accepted)
    print("other", scene.send().accepted)
    scene.server.register_goal_callback(None)


def handles(scene):
    """The attributes of a client's handle."""
    scene.server.register_execute_callback(lambda handle: (handle.succeed(), result())[1])
    goal_id = scene.next_id()
    handle = scene.send(goal_id)
    scene.finish(handle)
    until(lambda: handle.status == 4, scene.executor)
    attempt("repr", lambda: repr(handle))
    attempt("equal", lambda: (handle == handle, handle == scene.send(), handle != handle))  # noqa: PLR0124
    attempt("hash", lambda: hash(handle))
    attempt("stamp", lambda: type(handle.stamp).__name__)
    attempt("result type", lambda: type(scene.finish(handle)).__name__)
    for wrong in (None, 1, Fibonacci.Result(), Fibonacci.Goal):
        refused("wrong goal", lambda wrong=wrong: scene.client.send_goal_async(wrong))
        refused("wrong goal", lambda wrong=wrong: scene.client.send_goal(wrong))
    attempt("wrong handle", lambda: scene.client._cancel_goal_async(3))
    attempt("wrong handle", lambda: scene.client._get_result_async(None))
    attempt("entities", scene.client.get_num_entities)
    attempt("entities", scene.server.get_num_entities)
    attempt("action type", lambda: scene.server.action_type)
    unknown = type(handle)(scene.client, scene.next_id(), None)
    ended = scene.finish(unknown)
    print("unknown goal", ended.status, ended.result.sequence)


def constructions(scene):
    """Names and types that are refused, and servers with other profiles."""
    node, execute = scene.node, lambda handle: result()
    # Since rcl 9.2.8 a name that ends with a slash is refused with another reason.
    for name in ("", "a b", "1fib", "{bad}/x", "a//b", "~fib", "x" * 250):
        for make in (
            lambda name=name: ActionServer(node, Fibonacci, name, execute),
            lambda name=name: ActionClient(node, Fibonacci, name),
        ):
            attempt(f"name {name[:9]!r}", make, lambda made: made.destroy())
    for kind in (int, "Fibonacci", None):
        attempt("type", lambda kind=kind: ActionServer(node, kind, "other", execute))
        attempt("type", lambda kind=kind: ActionClient(node, kind, "other"))
    for timeout in (-1, float("inf"), float("nan"), 1e12):
        attempt(
            "timeout",
            lambda timeout=timeout: ActionServer(node, Fibonacci, "other", execute, result_timeout=timeout),
        )
    attempt("execute", lambda: ActionServer(node, Fibonacci, "other", 7))
    for name in ("~/private", "{node}/part", "/absolute", "a__b"):
        server = ActionServer(node, Fibonacci, name, execute, feedback_pub_qos_profile=QoSProfile(depth=1))
        client = ActionClient(node, Fibonacci, name, feedback_sub_qos_profile=QoSProfile(depth=1))
        attempt(f"{name} found", lambda client=client: client.wait_for_server(10.0))
        client.destroy()
        server.destroy()
    client = ActionClient(node, Fibonacci, "nobody")
    attempt("nobody", client.server_is_ready)
    attempt("nobody", lambda: client.wait_for_server(0))
    attempt("nobody", lambda: client.wait_for_server(-1.0))
    attempt("nobody", lambda: client.wait_for_server(timeout_sec=0.1))
    future = client.send_goal_async(Fibonacci.Goal())
    print("pending", future.done(), future.cancelled())
    future.cancel()
    client.destroy()


def main() -> None:
    """Play every case with one server and one client."""
    rclpy.init()
    scene = Scene()
    for case in (
        answers,
        endings,
        feedback,
        deferred,
        duplicates,
        handles,
        constructions,
        destroyed_handle,
    ):
        print(f"--- {case.__name__}")
        case(scene)
    scene.client.destroy()
    scene.server.destroy()
    scene.node.destroy_node()
    rclpy.shutdown()
