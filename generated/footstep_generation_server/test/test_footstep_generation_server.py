"""Tests of what the node footstep_generation_server does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from footstep_generation_server.footstep_generation_server import FootstepGenerationServer
from humanoid.data import Stance, Support
from humanoid.robot.table import STANCE_WIDTH
from humanoid.ros import messages
from humanoid.spatial import Array
from humanoid_interfaces.srv import PlanFootsteps
from numpy import array

Response = PlanFootsteps.Response


def request(x: float, frame: str = "odom", **more: Any) -> PlanFootsteps.Request:
    feet: list[Array] = [array([0.0, side * STANCE_WIDTH / 2, 0.0]) for side in (1, -1)]
    goal = messages.stamped(0, messages.planar_pose(x, 0.1, 0.2))
    goal.header.frame_id = frame
    start = messages.stance(Stance(Support.BOTH, (feet[0], feet[1])), 0)
    return PlanFootsteps.Request(start=start, goal=goal, **more)


def test_steps_lead_to_the_goal(ros: Any) -> None:
    ros.start(FootstepGenerationServer, use_sim_time=False)
    answer = ros.call(PlanFootsteps, "/plan_footsteps", request(0.7))
    assert (answer.status, answer.message) == (Response.STATUS_PLANNED, "")
    legs = [step.leg for step in answer.plan.steps]
    assert all(one != other for one, other in pairwise(legs))
    last, before = (step.position for step in answer.plan.steps[:-3:-1])
    assert ((last.x + before.x) / 2, (last.y + before.y) / 2) == pytest.approx((0.7, 0.1), abs=0.001)


@pytest.mark.parametrize(
    ("asked", "status"),
    [
        (request(0.7, "map"), Response.STATUS_UNKNOWN_FRAME),
        (request(math.nan), Response.STATUS_INVALID_REQUEST),
        (request(0.7, max_step_length=-0.1), Response.STATUS_INVALID_REQUEST),
        (request(0.7, first_leg=7), Response.STATUS_INVALID_REQUEST),
        (request(1e6), Response.STATUS_BLOCKED),
    ],
)
def test_what_cannot_be_planned_is_said(ros: Any, asked: PlanFootsteps.Request, status: int) -> None:
    ros.start(FootstepGenerationServer, use_sim_time=False)
    answer = ros.call(PlanFootsteps, "/plan_footsteps", asked)
    assert answer.status == status, answer.message
    assert answer.message
    assert not answer.plan.steps
