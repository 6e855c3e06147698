"""Cancelling: which goals are asked about, what the answer lists, and what an execute callback sees."""

import rclpy
from action_msgs.msg import GoalInfo, GoalStatus
from action_msgs.srv import CancelGoal
from builtin_interfaces.msg import Time
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.executors import SingleThreadedExecutor
from rclpy.task import Future
from test_msgs.action import Fibonacci
from transcript import attempt, until
from unique_identifier_msgs.msg import UUID


class Scene:
    """A server that lets goals wait, its client, and a raw client that can ask for any cancellation."""

    def __init__(self):
        self.node = rclpy.create_node("actor")
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.waiting = []
        self.server = ActionServer(
            self.node,
            Fibonacci,
            "fib",
            self.execute,
            goal_callback=lambda goal: GoalResponse.ACCEPT,
            handle_accepted_callback=self.waiting.append,
            cancel_callback=self.may_cancel,
        )
        self.client = ActionClient(self.node, Fibonacci, "fib")
        self.raw = self.node.create_client(CancelGoal, "fib/_action/cancel_goal")
        self.answer = CancelResponse.ACCEPT
        self.asked = []
        self.number = 0
        self.client.wait_for_server(10.0)
        self.raw.wait_for_service(10.0)

    def execute(self, handle):
        print("executes", handle.goal_id.uuid[0], handle.status, handle.is_cancel_requested)
        if handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.succeed()
        return Fibonacci.Result(sequence=[handle.status])

    def may_cancel(self, handle):
        number = int(handle.goal_id.uuid[0])
        self.asked.append((number, type(handle).__name__, handle.status))
        return self.answer(number) if callable(self.answer) else self.answer

    def spin(self, future):
        until(future.done, self.executor)
        return future.result()

    def goal(self):
        self.number += 1
        handle = self.spin(self.client.send_goal_async(Fibonacci.Goal(), None, UUID(uuid=[self.number] * 16)))
        return handle, self.waiting[-1]

    def request(self, label, number=0, stamp=None):
        """Send a raw request: about one goal, or about all up to a time."""
        info = GoalInfo(goal_id=UUID(uuid=[number] * 16), stamp=stamp or Time())
        del self.asked[:]
        response = self.spin(self.raw.call_async(CancelGoal.Request(goal_info=info)))
        listed = sorted(int(each.goal_id.uuid[0]) for each in response.goals_canceling)
        print(f"{label}: code {response.return_code}, listed {listed}, asked {self.asked}")
        return response

    def end(self):
        """Let all waiting goals finish."""
        for handle in self.waiting:
            if handle.is_active:
                if not handle.is_cancel_requested:
                    handle._update_state(rclpy.action.server.GoalEvent.EXECUTE)
                handle.succeed()
        del self.waiting[:]


def by_client(scene):
    """A client's own cancellation."""
    handle, served = scene.goal()
    response = scene.spin(handle.cancel_goal_async())
    print("accepted", response.return_code, len(response.goals_canceling), type(response).__name__)
    print("server", served.status, served.is_cancel_requested, served.is_active)
    until(lambda: handle.status == GoalStatus.STATUS_CANCELING, scene.executor)
    print("client", handle.status)
    served.execute()
    ended = scene.spin(handle.get_result_async())
    print("ended", ended.status, ended.result.sequence)
    again = scene.spin(handle.cancel_goal_async())
    print("again", again.return_code, len(again.goals_canceling))


def answers(scene):
    """Any answer other than ACCEPT rejects; the code stays 0."""
    for answer in (CancelResponse.REJECT, None, True, 2, GoalResponse.ACCEPT):
        handle, served = scene.goal()
        scene.answer = answer
        response = scene.spin(handle.cancel_goal_async())
        print(answer, response.return_code, len(response.goals_canceling), served.status)

    async def slowly(handle):
        return CancelResponse.ACCEPT

    scene.server.register_cancel_callback(slowly)
    handle, served = scene.goal()
    response = scene.spin(handle.cancel_goal_async())
    print("coroutine", response.return_code, len(response.goals_canceling), served.status)
    scene.server.register_cancel_callback(None)
    handle, served = scene.goal()
    response = scene.spin(handle.cancel_goal_async())
    print("default", response.return_code, len(response.goals_canceling), served.status)
    scene.server.register_cancel_callback(scene.may_cancel)
    scene.answer = CancelResponse.ACCEPT
    scene.end()


def requests(scene):
    """The rules of CancelGoal: zero id, zero stamp, and everything between."""
    scene.request("nothing there")
    scene.request("unknown", 200)
    scene.request("past", stamp=Time(sec=1))
    (_, first), (_, second), (_, third) = goals = [scene.goal() for _ in range(3)]
    base = scene.number - 3
    stamps = [(handle.stamp.sec, handle.stamp.nanosec) for handle, _ in goals]
    print("in order", stamps == sorted(stamps))
    scene.request("past and id", base + 2, Time(sec=1))
    scene.request("past", stamp=Time(sec=1))
    print([each.status for each in (first, second, third)])
    scene.request("already", base + 2)
    scene.request("all")
    print([each.status for each in (first, second, third)])
    scene.request("all again")
    scene.end()
    scene.request("ended", base + 1)
    scene.request("ended", 0)
    goals = [scene.goal() for _ in range(3)]
    latest = goals[-1][0].stamp
    # The client's stamp may be older than the server's by some microseconds.
    scene.request("until now", stamp=Time(sec=latest.sec + 1, nanosec=latest.nanosec))
    scene.end()


def some_of_all(scene):
    """All goals are asked about; those that may be cancelled are."""
    goals = [scene.goal() for _ in range(4)]
    base = scene.number - 4
    scene.answer = lambda number: CancelResponse.ACCEPT if (number - base) > 1 else CancelResponse.REJECT
    info = GoalInfo()
    response = scene.spin(scene.raw.call_async(CancelGoal.Request(goal_info=info)))
    canceled = [served.status for _, served in goals]
    print("all but the first", response.return_code, canceled[2:])
    scene.answer = CancelResponse.ACCEPT
    scene.end()


def while_executing(scene):
    """A coroutine sees the request to stop; canceling without a request is refused."""
    go_on = Future()

    async def execute(handle):
        await go_on
        print("requested", handle.is_cancel_requested, handle.status)
        handle.publish_feedback(Fibonacci.Feedback())
        handle.canceled()
        return Fibonacci.Result(sequence=[5])

    async def ignore(handle):
        await go_on
        print("ignores", handle.is_cancel_requested)
        handle.succeed()
        return Fibonacci.Result(sequence=[6])

    async def give_up(handle):
        await go_on
        handle.abort()
        return Fibonacci.Result(sequence=[7])

    async def unasked(handle):
        await go_on
        attempt("unasked", handle.canceled)
        handle.abort()
        return Fibonacci.Result()

    for callback in (execute, ignore, give_up, unasked):
        go_on = Future()
        handle, served = scene.goal()
        served.execute(callback)
        until(lambda served=served: served.status == GoalStatus.STATUS_EXECUTING, scene.executor)
        if callback is not unasked:
            response = scene.spin(handle.cancel_goal_async())
            print("canceling", response.return_code, len(response.goals_canceling))
        go_on.set_result(None)
        ended = scene.spin(handle.get_result_async())
        print(callback.__name__, ended.status, ended.result.sequence)


def ends_meanwhile(scene):
    """The goal succeeds while the cancel callback runs."""
    handle, served = scene.goal()

    def answer(number):
        served._update_state(rclpy.action.server.GoalEvent.EXECUTE)
        served.succeed()
        return CancelResponse.ACCEPT

    scene.answer = answer
    response = scene.spin(handle.cancel_goal_async())
    print("meanwhile", response.return_code, len(response.goals_canceling), served.status)


def main() -> None:
    """Play every case."""
    rclpy.init()
    scene = Scene()
    for case in (by_client, answers, requests, some_of_all, while_executing, ends_meanwhile):
        print(f"--- {case.__name__}")
        case(scene)
    rclpy.shutdown()
