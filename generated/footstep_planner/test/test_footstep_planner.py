"""Tests of what the node footstep_planner does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from footstep_planner._footstep_planner_base import (
    GAIT_STATE_SUBSCRIPTION_QOS,
    HUMANOID_CMD_VEL_PUBLISHER_QOS,
    MAP_SUBSCRIPTION_QOS,
    TELEOP_VELOCITY_SUBSCRIPTION_QOS,
)
from footstep_planner.footstep_planner import FootstepPlanner
from geometry_msgs.msg import Twist, Vector3
from humanoid.data import GaitState as State
from humanoid.data import Leg, Mode, Stance, Support
from humanoid.planning.footsteps import plan_footsteps
from humanoid.robot.grid import Grid
from humanoid.robot.table import STANCE_WIDTH
from humanoid.ros import messages
from humanoid.ros.grids import occupancy_grid, path
from humanoid_interfaces.msg import GaitState
from humanoid_interfaces.srv import FollowPath, PlanFootsteps
from nav_msgs.msg import OccupancyGrid, Path

Response = PlanFootsteps.Response
HERE = Stance(Support.BOTH, (np.array([0.0, STANCE_WIDTH / 2, 0.0]), np.array([0.0, -STANCE_WIDTH / 2, 0.0])))
CORNER = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.2))


def block(x: float, y: float) -> OccupancyGrid:
    """A map with one occupied cell."""
    cells = np.zeros((80, 80), dtype=np.int8)
    cells[int((y + 4) * 10), int((x + 4) * 10)] = 100
    return occupancy_grid(Grid(0.1, -4.0, -4.0, cells), 0)


def serve(ros: Any) -> None:
    """Answer as footstep_generation_server does: straight to the goal."""

    def answer(asked: PlanFootsteps.Request, response: PlanFootsteps.Response) -> PlanFootsteps.Response:
        x, y, yaw = (float(part) for part in messages.planar(asked.goal.pose))
        leg = Leg(asked.first_leg) if asked.first_leg else None
        result = plan_footsteps(messages.read_stance(asked.start), (x, y, yaw), first_leg=leg)
        response.status, response.message = int(result.status), result.message
        response.plan = messages.footstep_plan(result.plan, 0)
        return response

    ros.peer.create_service(PlanFootsteps, "/plan_footsteps", answer)


def request(**more: Any) -> FollowPath.Request:
    return FollowPath.Request(
        start=messages.stance(HERE, 0), path=path(CORNER, 0.5, 0), first_index=5, **more
    )


def told(ros: Any, node: FootstepPlanner, where: OccupancyGrid) -> None:
    """Tell the planner where the robot and an obstacle are."""
    maps = ros.peer.create_publisher(OccupancyGrid, "/map", MAP_SUBSCRIPTION_QOS)
    gaits = ros.peer.create_publisher(GaitState, "/gait_state", GAIT_STATE_SUBSCRIPTION_QOS)
    state = messages.gait_state(State(0, Mode.STANDING, "", HERE, 0, 0, 0.0))

    def tell() -> None:
        maps.publish(where)
        gaits.publish(state)

    ros.deliver(tell, lambda: node._gait is not None and len(node._points), "map and gait state")


def test_steps_lead_round_the_corner_to_the_end(ros: Any) -> None:
    serve(ros)
    ros.start(FootstepPlanner, use_sim_time=False)
    answer = ros.call(FollowPath, "/follow_path", request())
    assert (answer.status, answer.message) == (Response.STATUS_PLANNED, "")
    steps = answer.plan.steps
    assert [step.index for step in steps] == list(range(5, 5 + len(steps)))
    assert all(one.leg != other.leg for one, other in pairwise(steps))
    middle = [(one.position.x + other.position.x) / 2 for one, other in pairwise(steps)]
    assert 0.8 < max(middle) < 1.15
    last, before = steps[-1].position, steps[-2].position
    assert ((last.x + before.x) / 2, (last.y + before.y) / 2) == pytest.approx((1.0, 1.2), abs=0.005)


def test_steps_into_an_obstacle_are_not_planned(ros: Any) -> None:
    serve(ros)
    node = ros.start(FootstepPlanner, use_sim_time=False)
    told(ros, node, block(1.0, 0.6))
    answer = ros.call(FollowPath, "/follow_path", request())
    assert answer.status == Response.STATUS_BLOCKED
    assert "m from an obstacle" in answer.message
    assert not answer.plan.steps


@pytest.mark.parametrize(
    ("asked", "why"),
    [
        (request(first_leg=7), "there is no leg 7"),
        (request(max_step_length=-1.0), "max_step_length is -1 m"),
        (FollowPath.Request(start=messages.stance(HERE, 0), path=Path()), "this one has 0 poses"),
    ],
)
def test_what_cannot_be_followed_is_said(ros: Any, asked: FollowPath.Request, why: str) -> None:
    ros.start(FootstepPlanner, use_sim_time=False)
    answer = ros.call(FollowPath, "/follow_path", asked)
    assert answer.status == Response.STATUS_INVALID_REQUEST
    assert why in answer.message


def test_a_velocity_stops_at_an_obstacle_and_may_lead_away_from_it(ros: Any) -> None:
    node = ros.start(FootstepPlanner)
    told(ros, node, block(0.7, 0.0))
    heard: list[Twist] = []
    ros.peer.create_subscription(Twist, "/humanoid/cmd_vel", heard.append, HUMANOID_CMD_VEL_PUBLISHER_QOS)
    sticks = ros.peer.create_publisher(Twist, "/teleop/velocity", TELEOP_VELOCITY_SUBSCRIPTION_QOS)
    for forward, passed in ((-0.2, -0.2), (0.2, 0.0), (0.0, 0.0), (-0.1, -0.1)):
        heard.clear()
        command = Twist(linear=Vector3(x=forward))
        ros.deliver(
            lambda command=command: sticks.publish(command),
            lambda passed=passed: heard and heard[-1].linear.x == passed,
            f"{passed} on /humanoid/cmd_vel",
        )
