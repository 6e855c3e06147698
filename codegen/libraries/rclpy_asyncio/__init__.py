"""ROS nodes on asyncio: callbacks, calls and goals are coroutines of the user's event loop.

ROS 2 Lyrical has `AsyncNode` in `rclpy.experimental`. This one runs on our own rclpy and on real rclpy of
Jazzy and Kilted, and has actions besides.
"""

from rclpy_asyncio.action_client import AsyncActionClient, AsyncGoalHandle, GoalRejectedError
from rclpy_asyncio.action_server import AsyncActionServer
from rclpy_asyncio.clock import AsyncClock, AsyncTimer, TimeSourceChangedError
from rclpy_asyncio.driver import wrap_future
from rclpy_asyncio.entities import AsyncClient, AsyncPublisher, AsyncService, AsyncSubscription
from rclpy_asyncio.node import AsyncNode, spin

__all__ = [
    "AsyncActionClient",
    "AsyncActionServer",
    "AsyncClient",
    "AsyncClock",
    "AsyncGoalHandle",
    "AsyncNode",
    "AsyncPublisher",
    "AsyncService",
    "AsyncSubscription",
    "AsyncTimer",
    "GoalRejectedError",
    "TimeSourceChangedError",
    "spin",
    "wrap_future",
]
