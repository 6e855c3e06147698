"""A rover that drives on paper: a node with a topic each way, a service and an action."""

import math
import threading
import time

from geometry_msgs.msg import Twist
from rclpy.action import ActionServer, CancelResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rover_msgs.action import Drive
from rover_msgs.msg import State
from rover_msgs.srv import Place

PERIOD = 0.1
SPEED = 0.5  # of an action, in m/s
PATIENCE = 0.5  # seconds after the last command until it stops
TRAIL = 200  # values in `trail`


class Rover(Node):
    """Moves as `cmd_vel` says or as the action `drive` does, and tells where it is."""

    def __init__(self) -> None:
        super().__init__("rover")
        self._lock = threading.Lock()
        self._state = State()
        self._until = 0.0
        at_once = ReentrantCallbackGroup()  # a goal that is driven must not keep the timer waiting
        self._states = self.create_publisher(State, "state", 10)
        self.create_subscription(Twist, "cmd_vel", self._command, 10, callback_group=at_once)
        self.create_service(Place, "place", self._place, callback_group=at_once)
        self.create_timer(PERIOD, self._move, callback_group=at_once)
        self._drives = ActionServer(
            self,
            Drive,
            "drive",
            self._drive,
            callback_group=at_once,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    def _command(self, speed: Twist) -> None:
        with self._lock:
            self._state.speed, self._until = speed, time.monotonic() + PATIENCE

    def _place(self, request: Place.Request, response: Place.Response) -> Place.Response:
        if not all(map(math.isfinite, (request.x, request.y, request.heading))):
            response.message = "that is nowhere"
            return response
        with self._lock:
            state = self._state
            state.x, state.y, state.heading, state.trail = request.x, request.y, request.heading, []
        response.success, response.message = True, f"at {request.x:g} m, {request.y:g} m"
        return response

    def _move(self) -> None:
        with self._lock:
            state = self._state
            if time.monotonic() > self._until:
                state.speed = Twist()
            state.heading += state.speed.angular.z * PERIOD
            self._step(state.speed.linear.x * PERIOD)
            moving = state.speed != Twist()
            state.mode = State.MODE_DRIVING if moving else State.MODE_IDLE
            state.stamp = self.get_clock().now().to_msg()
            state.count += 1
            self._states.publish(state)

    def _step(self, distance: float) -> None:
        state = self._state
        state.x += distance * math.cos(state.heading)
        state.y += distance * math.sin(state.heading)
        if distance:
            state.trail = [*state.trail, state.x, state.y][-TRAIL:]

    def _drive(self, handle: ServerGoalHandle) -> Drive.Result:
        goal, driven = handle.request.distance, 0.0
        while driven < goal and not handle.is_cancel_requested:
            time.sleep(PERIOD)
            step = min(SPEED * PERIOD, goal - driven)
            with self._lock:
                self._step(step)
            driven += step
            handle.publish_feedback(Drive.Feedback(remaining=goal - driven))
        if handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.succeed()
        return Drive.Result(driven=driven)
