"""Trials of the robot through messages alone, for `graph.NodeGraph` to play in tests and benchmarks."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseStamped
from humanoid_interfaces.srv import CheckHeadPose, SolveIK
from std_srvs.srv import SetBool

from ..data import Mode
from ..kinematics import poses
from ..kinematics.chains import CHAINS, ChainKinematics
from ..kinematics.head import HeadMode
from ..kinematics.ik import IkStatus
from ..kinematics.poses import Pose
from ..robot import model as models
from ..ros import messages
from ..seeds import generator
from .trials import STRAIGHT
from .user import ScenarioError, User

LEFT_CHAINS = tuple(name for name in CHAINS if not name.startswith("right"))
"""Chains that differ by more than their side."""

BETWEEN_PUSHES = 5.0  # s
_LONGEST_WALK = 90.0  # s
_LOOK = 0.1  # s between checks of a walk under way


async def stand(user: User, seconds: float) -> float:
    """Do nothing; returns the largest distance of base_link from its start [m]."""
    start, worst = user.place, 0.0
    end = user.now + seconds
    while user.now < end and not user.fallen:
        await user.wait(0.02)
        worst = max(worst, float(np.linalg.norm(user.place - start)))
    return worst


async def walk_straight(user: User) -> None:
    """Walk twelve steps."""
    user.send(STRAIGHT)
    await user.taken(STRAIGHT)


async def walk_to(user: User, goal: tuple[float, float, float], momentum: float, seed: int) -> bool:
    """Walk to a goal, pushed every five seconds from a random side [N s]; returns whether it was reached."""
    random = generator(seed, "pushes")
    handle = await user.begin_walk(*goal)
    result = handle.get_result_async()
    began = pushed = user.now
    while not result.done():
        await user.wait(_LOOK)
        if momentum and user.now - pushed >= BETWEEN_PUSHES:
            user.push(momentum, random.uniform(0.0, 2 * math.pi))
            pushed = user.now
        if user.now - began > _LONGEST_WALK:
            raise ScenarioError(f"not there after {_LONGEST_WALK:.0f} s")
    answer: Any = result.result()
    if answer.status == GoalStatus.STATUS_SUCCEEDED:
        user.score.goal_errors.append(user.distance_to(*goal[:2]))
    return bool(answer.status == GoalStatus.STATUS_SUCCEEDED)


async def cancel_walk(user: User, goal: tuple[float, float, float], after: float) -> None:
    """Begin a walk and cancel it some seconds later; wait until the robot stands."""
    handle = await user.begin_walk(*goal)
    await user.wait(after)
    await user.cancel(handle)
    await user.until(Mode.STANDING)


async def push_standing(user: User, momentum: float, degrees: float) -> None:
    """Push once, and wait until that is over."""
    user.push(momentum, math.radians(degrees))
    await user.wait(3.0)
    await user.until(Mode.STANDING)


async def push_walking(user: User, momentum: float, degrees: float, after: float) -> None:
    """Push once in a straight walk, some seconds after its plan was sent."""
    user.send(STRAIGHT)
    await user.wait(after)
    user.push(momentum, math.radians(degrees))
    await user.taken(STRAIGHT)


async def disturbed(user: User) -> None:
    """Walk, push and cancel, in about four seconds."""
    handle = await user.begin_walk(1.0, 0.4, 1.0)
    await user.wait(2.0)
    user.push(3.0, 1.0)
    await user.wait(0.5)
    await user.cancel(handle)


async def dance(user: User, name: str) -> None:
    """Dance a whole dance."""
    await user.dance(name)


async def kinematics(user: User, count: int, others: int) -> dict[str, tuple[int, int]]:
    """Ask both services for reachable and unreachable poses, while time stands still.

    Returns, by chain and for "head pose", how many of each they claim to reach.
    """
    client = user.create_client(SolveIK, "/solve_ik")
    checker = user.create_client(CheckHeadPose, "/check_head_pose")
    pause = user.create_client(SetBool, "/humanoid_simulator/pause")
    model = models.load()

    async def solved(chain: str, tried: Iterator[Pose]) -> int:
        timeout = messages.duration_of(60.0)
        requests = (SolveIK.Request(chain=chain, target=_target(pose), timeout=timeout) for pose in tried)
        answers = [await client.call_async(request) for request in requests]
        return sum(answer.status == IkStatus.SOLVED for answer in answers)

    async def checked(tried: Iterator[Pose]) -> int:
        requests = (CheckHeadPose.Request(mode=int(HeadMode.POSE), target=_target(pose)) for pose in tried)
        answers = [await checker.call_async(request) for request in requests]
        return sum(answer.reachable for answer in answers)

    await pause.call_async(SetBool.Request(data=True))
    found = {}
    for name in LEFT_CHAINS:
        tip, random = ChainKinematics(model, CHAINS[name]), np.random.default_rng(1)
        able, unable = poses.reachable(tip, random, count), poses.beyond(tip, random, others)
        found[name] = await solved(name, able), await solved(name, unable)
    tip, random = ChainKinematics(model, CHAINS["head"]), np.random.default_rng(2)
    able, unable = poses.reachable(tip, random, count), poses.beyond(tip, random, others, nearest=1.05)
    found["head pose"] = await checked(able), await checked(unable)
    await pause.call_async(SetBool.Request(data=False))
    return found


def _target(pose: Pose) -> PoseStamped:
    target = messages.stamped(0, messages.planar_pose(0.0, 0.0, 0.0))
    target.header.frame_id = "base_link"
    target.pose.position = messages.point(*pose[0])
    target.pose.orientation = messages.quaternion(pose[1])
    return target
