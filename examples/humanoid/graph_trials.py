"""What tests and benchmarks ask of the robot by messages alone, for `graph.NodeGraph` to play."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseStamped
from humanoid_interfaces.srv import CheckHeadPose, SolveIK
from std_srvs.srv import SetBool

from . import messages
from .data import FootstepPlan, Mode
from .director import Director, ScenarioError
from .head import HeadMode
from .ik import IkStatus
from .poses import Pose
from .reference import straight_steps
from .seeds import generator

STRAIGHT = FootstepPlan(1, straight_steps(12, 0.18, 0.18), (1.98, 0.0, 0.0))
"""Twelve steps of 0.18 m straight ahead."""

_BETWEEN_PUSHES = 5.0  # s
_LONGEST_WALK = 90.0  # s
_LOOK = 0.1  # s between looks at a walk under way


async def stand(director: Director, seconds: float) -> float:
    """Do nothing; gives how far base_link was at most from where it began [m]."""
    start, worst = director.base, 0.0
    end = director.now + seconds
    while director.now < end and not director.score.falls:
        await director.wait(0.02)
        worst = max(worst, float(np.linalg.norm(director.base - start)))
    return worst


async def walk_straight(director: Director) -> None:
    """Twelve steps."""
    director.send(STRAIGHT)
    await director.taken(STRAIGHT)


async def walk_to(director: Director, goal: tuple[float, float, float], momentum: float, seed: int) -> bool:
    """Walk to a goal, pushed every five seconds from anywhere [N s]; gives whether it was reached."""
    random = generator(seed, "pushes")
    handle = await director.begin_walk(*goal)
    result = handle.get_result_async()
    began = pushed = director.now
    while not result.done():
        await director.wait(_LOOK)
        if momentum and director.now - pushed >= _BETWEEN_PUSHES:
            director.push(momentum, random.uniform(0.0, 2 * math.pi))
            pushed = director.now
        if director.now - began > _LONGEST_WALK:
            raise ScenarioError(f"not there after {_LONGEST_WALK:.0f} s")
    answer: Any = result.result()
    if answer.status == GoalStatus.STATUS_SUCCEEDED:
        director.score.goal_errors.append(director.distance_to(*goal[:2]))
    return bool(answer.status == GoalStatus.STATUS_SUCCEEDED)


async def cancel_walk(director: Director, goal: tuple[float, float, float], after: float) -> None:
    """Begin a walk and cancel it some seconds later; the robot stands in the end."""
    handle = await director.begin_walk(*goal)
    await director.wait(after)
    await director.cancel(handle)
    await director.until(Mode.STANDING)


async def push_standing(director: Director, momentum: float, degrees: float) -> None:
    """Push once, and wait until that is over."""
    director.push(momentum, math.radians(degrees))
    await director.wait(3.0)
    await director.until(Mode.STANDING)


async def push_walking(director: Director, momentum: float, degrees: float, after: float) -> None:
    """Push once in a straight walk, some seconds after its plan was sent."""
    director.send(STRAIGHT)
    await director.wait(after)
    director.push(momentum, math.radians(degrees))
    await director.taken(STRAIGHT)


async def disturbed(director: Director) -> None:
    """A walk, a push, a cancel, in four seconds or so."""
    handle = await director.begin_walk(1.0, 0.4, 1.0)
    await director.wait(2.0)
    director.push(3.0, 1.0)
    await director.wait(0.5)
    await director.cancel(handle)


async def solve(director: Director, chain: str, poses: Iterator[Pose]) -> list[bool]:
    """Ask the IK server for each pose, while time stands still; gives which it says it has solved."""
    client = director.create_client(SolveIK, "/inverse_kinematics_server/solve_ik")
    requests = (
        SolveIK.Request(chain=chain, target=_target(pose), timeout=messages.duration_of(60.0))
        for pose in poses
    )
    return [answer.status == IkStatus.SOLVED for answer in await _ask(director, client, requests)]


async def check_head(director: Director, poses: Iterator[Pose], mode: HeadMode) -> list[bool]:
    """Ask for each pose of the head, while time stands still; gives which it says can be reached."""
    client = director.create_client(CheckHeadPose, "/inverse_kinematics_server/check_head_pose")
    requests = (CheckHeadPose.Request(mode=int(mode), target=_target(pose)) for pose in poses)
    return [answer.reachable for answer in await _ask(director, client, requests)]


async def _ask(director: Director, client: Any, requests: Iterator[Any]) -> list[Any]:
    pause = director.create_client(SetBool, "/humanoid_simulator/pause")
    await pause.call_async(SetBool.Request(data=True))
    answers = [await client.call_async(request) for request in requests]
    await pause.call_async(SetBool.Request(data=False))
    director.destroy_client(pause)
    director.destroy_client(client)
    return answers


def _target(pose: Pose) -> PoseStamped:
    target = messages.stamped(0, messages.planar_pose(0.0, 0.0, 0.0))
    target.header.frame_id = "base_link"
    target.pose.position = messages.point(*pose[0])
    target.pose.orientation = messages.quaternion(pose[1])
    return target
