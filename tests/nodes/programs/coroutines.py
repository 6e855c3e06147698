"""Coroutine callbacks that wait for services and actions of nodes on the same single thread."""

import time

import rclpy
from action_msgs.msg import GoalStatus
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from robot._waiting import GoalRejected
from robot.brain import Brain
from robot.msg import Joint
from stage import Stage, say

rclpy.init()


class Thinker(Brain):
    """A node whose callbacks wait for others; it prints what it learns."""

    def __init__(self) -> None:
        super().__init__()
        self.ticks = 0
        self.most_ticks = 0
        self._in_tick = 0

    async def handle_ask(
        self, request: AddTwoInts.Request, response: AddTwoInts.Response
    ) -> AddTwoInts.Response:
        """Call another service, on the same thread, twice."""
        first = await self.call_add(request)
        second = await self.call_add(AddTwoInts.Request(a=first.sum, b=request.b))
        response.sum = second.sum
        return response

    async def on_target(self, message: Joint) -> None:
        """Wait for the action that the name says."""
        await {
            "slow": self.slow,
            "missing": self.missing,
            "goal": self.goal,
            "cancel": self.cancel,
            "reject": self.reject,
        }[message.name]()

    async def slow(self) -> None:
        """A service that takes too long."""
        try:
            await self.call_add(AddTwoInts.Request(a=-1), timeout_sec=0.2)
        except TimeoutError as error:
            say("too slow", error)

    async def missing(self) -> None:
        """A service that is not there."""
        self.destroy_client(self.add_client)
        self.add_client = self.create_client(AddTwoInts, "nowhere", callback_group=ReentrantCallbackGroup())
        started = time.monotonic()
        try:
            await self.call_add(AddTwoInts.Request(), timeout_sec=0.3)
        except TimeoutError as error:
            say("not there", error, 0.25 < time.monotonic() - started < 5)

    async def goal(self) -> None:
        """Feedback, then the result."""
        goal = await self.send_fibonacci(Fibonacci.Goal(order=4))
        try:
            await goal.result(timeout_sec=0.0)
        except TimeoutError as error:
            say("early", error)
        async for feedback in goal:
            say("feedback", list(feedback.sequence))
        result = await goal.result()
        say("result", list(result.sequence), goal.status == GoalStatus.STATUS_SUCCEEDED)

    async def cancel(self) -> None:
        """A goal that is given up after its first feedback."""
        goal = await self.send_fibonacci(Fibonacci.Goal(order=50))
        async for _ in goal:
            say("cancels", await goal.cancel())
            break
        say(
            "cancelled",
            list((await goal.result(timeout_sec=10.0)).sequence),
            goal.status == GoalStatus.STATUS_CANCELED,
        )

    async def reject(self) -> None:
        """A goal that the server rejects."""
        try:
            await self.send_fibonacci(Fibonacci.Goal(order=-1))
        except GoalRejected as error:
            say("rejected", error)

    async def on_think_timer(self) -> None:
        """Take longer than a period: the next one has to wait."""
        self._in_tick += 1
        self.most_ticks = max(self.most_ticks, self._in_tick)
        await self.sleep(0.25)
        self._in_tick -= 1
        self.ticks += 1

    async def execute_act(self, goal_handle: ServerGoalHandle) -> Fibonacci.Result:
        """Run until cancelled."""
        goal_handle.publish_feedback(Fibonacci.Feedback())
        while not goal_handle.is_cancel_requested:
            await self.sleep(0.02)
        goal_handle.canceled()
        return Fibonacci.Result(sequence=[1])


class Server(Node):
    """An adder that is slow with negative numbers, and an action with a few steps per second."""

    def __init__(self) -> None:
        super().__init__("server")
        group = ReentrantCallbackGroup()
        self.create_service(AddTwoInts, "add", self.add, callback_group=group)
        self.action = ActionServer(
            self,
            Fibonacci,
            "fibonacci",
            self.execute,
            callback_group=group,
            goal_callback=lambda goal: GoalResponse.ACCEPT if goal.order >= 0 else GoalResponse.REJECT,
            cancel_callback=lambda goal: CancelResponse.ACCEPT,
        )

    async def pause(self, seconds: float) -> None:
        """Wait on a timer."""
        future = rclpy.task.Future()
        timer = self.create_timer(
            seconds, lambda: future.set_result(None), callback_group=ReentrantCallbackGroup()
        )
        await future
        self.destroy_timer(timer)

    async def add(self, request: AddTwoInts.Request, response: AddTwoInts.Response) -> AddTwoInts.Response:
        """Add."""
        if request.a < 0:
            await self.pause(1.0)
        response.sum = request.a + request.b
        return response

    async def execute(self, goal: ServerGoalHandle) -> Fibonacci.Result:
        """Count."""
        sequence: list[int] = []
        for step in range(goal.request.order):
            if goal.is_cancel_requested:
                goal.canceled()
                return Fibonacci.Result(sequence=sequence[:1])
            sequence.append(step)
            goal.publish_feedback(Fibonacci.Feedback(sequence=sequence))
            await self.pause(0.05)
        goal.succeed()
        return Fibonacci.Result(sequence=sequence)


brain, server = Thinker(), Server()
stage = Stage(brain, server)
target = stage.peer.create_publisher(Joint, "target", 5)
assert stage.until(lambda: target.get_subscription_count() == 1) is True
say("asked", stage.call(AddTwoInts, "brain/ask", AddTwoInts.Request(a=1, b=10)).sum)
for name, seconds in (("goal", 1.5), ("reject", 0.5), ("cancel", 1.0), ("slow", 0.8)):
    target.publish(Joint(name=name))
    stage.during(seconds)
say("ticks", brain.ticks > 3, brain.most_ticks)
target.publish(Joint(name="missing"))
stage.during(1.0)

# Its own action can be cancelled while it runs.
client = rclpy.action.ActionClient(stage.peer, Fibonacci, "brain/act")
assert stage.until(client.server_is_ready) is True
handle = stage.result(client.send_goal_async(Fibonacci.Goal(order=1)))
stage.during(0.1)
say("agrees", len(stage.result(handle.cancel_goal_async()).goals_canceling))
response = stage.result(handle.get_result_async())
say("gave up", list(response.result.sequence), response.status == GoalStatus.STATUS_CANCELED)
for node in (brain, server, stage.peer):
    node.destroy_node()
rclpy.shutdown()
