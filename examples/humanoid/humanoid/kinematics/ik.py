"""Inverse kinematics of the robot's chains, for the service SolveIK."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np

from ..robot.body import Body
from ..robot.model import HumanoidModel
from ..spatial import Array, matrix_of
from .chains import CHAINS, ChainKinematics, chains_of
from .descent import Tolerance, descend
from .leg_ik import solve_leg

POSITION_TOLERANCE, ORIENTATION_TOLERANCE = 1e-3, 5e-3  # metres, radians
ATTEMPTS = 50
TIMEOUT = 1.0  # seconds
FARTHEST = 1e6  # the largest number in a target: squares of it are numbers, too
_MOST_ATTEMPTS = 10_000


class IkStatus(IntEnum):
    """The outcome of the search, as in SolveIK.srv."""

    UNKNOWN = 0
    SOLVED = 1
    UNREACHABLE = 2
    ATTEMPTS_EXHAUSTED = 3
    TIMED_OUT = 4
    UNKNOWN_CHAIN = 5
    UNKNOWN_FRAME = 6
    INVALID_REQUEST = 7


@dataclass(frozen=True, slots=True)
class IkRequest:
    """The request of SolveIK; the target is a pose in base_link. 0 means the server's own number."""

    chain: str
    position: Array  # (3,)
    orientation: Array  # (4,), of any length but 0
    seed: Mapping[str, float] = field(default_factory=dict)
    position_only: bool = False
    position_tolerance: float = 0.0
    orientation_tolerance: float = 0.0
    attempts: int = 0
    timeout: float = 0.0  # seconds
    random_seed: int = 0


@dataclass(frozen=True, slots=True)
class IkResult:
    """The response of SolveIK; `names` and `positions` are empty if the search did not begin."""

    status: IkStatus
    message: str
    names: tuple[str, ...] = ()
    positions: tuple[float, ...] = ()
    position_residual: float = math.nan
    orientation_residual: float = math.nan
    attempts: int = 0
    computing_time: float = 0.0  # seconds


class InverseKinematics:
    """Solves requests one after another. Equal requests get equal answers, unless time runs out."""

    def __init__(self, model: HumanoidModel, clock: Callable[[], float] = time.monotonic) -> None:
        self._model = model
        self._clock = clock
        chains = chains_of(model.body)
        self._kinematics = {name: ChainKinematics(model, chain) for name, chain in chains.items()}

    def solve(self, request: IkRequest, present: Array | None = None) -> IkResult:
        """Answer a request; `present` (joints,) is the present joint positions, zero if not given."""
        begun = self._clock()
        if problem := _problem(request, self._model.body):
            return IkResult(IkStatus.INVALID_REQUEST, problem)
        kinematics = self._kinematics.get(request.chain)
        if kinematics is None:
            return IkResult(IkStatus.UNKNOWN_CHAIN, self._unknown(request.chain))
        joints = np.zeros(len(self._model.lower)) if present is None else present.copy()
        for name, position in request.seed.items():
            joints[self._model.body.index(name)] = position
        kinematics.set_others(joints)
        target = (np.asarray(request.position, float), _rotation(request.orientation))
        start = joints[kinematics.indices]
        beyond = _beyond_reach(kinematics, target[0], tolerance := _tolerance(request))
        search = _Search(kinematics, target, tolerance)
        search.attempt(start)
        if not search.solved and not beyond:
            self._restart(search, request, begun)
        return self._answer(search, request, beyond, self._clock() - begun)

    def _unknown(self, chain: str) -> str:
        """Why there is no such chain."""
        if chain in CHAINS:
            limb = chain.removesuffix("_with_waist").replace("_", " ")
            return f"the robot has no {limb}: none of its joints is in the model"
        return f"there is no chain '{chain}'; I know {', '.join(self._kinematics)}"

    def _restart(self, search: _Search, request: IkRequest, begun: float) -> None:
        """Start again from other positions until it is solved, or until attempts or time run out."""
        kinematics = search.kinematics
        if (position := _leg_solution(self._model, request.chain, search.target)) is not None:
            search.attempt(position)
        random = np.random.default_rng(request.random_seed)
        attempts, timeout = request.attempts or ATTEMPTS, request.timeout or TIMEOUT
        while not search.solved and search.attempts < attempts:
            if self._clock() - begun > timeout:
                search.timed_out = True
                return
            search.attempt(random.uniform(kinematics.lower, kinematics.upper))

    def _answer(self, search: _Search, request: IkRequest, beyond: str, seconds: float) -> IkResult:
        error = search.error
        if search.solved:
            status, message = IkStatus.SOLVED, ""
        elif beyond:
            status, message = IkStatus.UNREACHABLE, beyond
        else:
            status = IkStatus.TIMED_OUT if search.timed_out else IkStatus.ATTEMPTS_EXHAUSTED
            why = f"{search.attempts} starts" if not search.timed_out else f"{seconds:.2f} s"
            message = f"after {why} the tip is still {np.linalg.norm(error[:3]) * 1e3:.1f} mm off"
            if not request.position_only:
                message += f" and {np.linalg.norm(error[3:]):.3f} rad turned"
        return IkResult(
            status,
            message,
            search.kinematics.chain.joints,
            tuple(float(position) for position in search.joints),
            float(np.linalg.norm(error[:3])),
            float(np.linalg.norm(error[3:])),
            search.attempts,
            seconds,
        )


class _Search:
    """The best of several descents."""

    def __init__(
        self, kinematics: ChainKinematics, target: tuple[Array, Array], tolerance: Tolerance
    ) -> None:
        self.kinematics, self.target, self._tolerance = kinematics, target, tolerance
        self.joints = self.error = np.zeros(0)
        self.attempts = 0
        self.solved = self.timed_out = False
        self._best = math.inf

    def attempt(self, start: Array) -> None:
        joints, error = descend(self.kinematics, start, self.target, self._tolerance)
        self.attempts += 1
        self.solved = self._tolerance.met(error)
        turned = 0.3 * float(np.linalg.norm(error[3:])) if math.isfinite(self._tolerance.orientation) else 0.0
        cost = float(np.linalg.norm(error[:3])) + turned
        if self.solved or cost < self._best:
            self._best, self.joints, self.error = cost, joints, error


def _leg_solution(model: HumanoidModel, chain: str, target: tuple[Array, Array]) -> Array | None:
    """The solution of a leg like ours in closed form; joint limits are not checked."""
    if not (chain.endswith("_leg") and model.has_our_legs):
        return None
    position, rotation = target
    ankle = (position + rotation @ np.array([0.0, 0.0, model.leg.ankle_height]), rotation)
    sign = 1 if chain == "left_leg" else -1
    return solve_leg(model.leg, sign, (np.zeros(3), np.eye(3)), ankle)[0]


def _tolerance(request: IkRequest) -> Tolerance:
    orientation = request.orientation_tolerance or ORIENTATION_TOLERANCE
    return Tolerance(
        request.position_tolerance or POSITION_TOLERANCE, math.inf if request.position_only else orientation
    )


def _rotation(orientation: Array) -> Array:
    quaternion = np.asarray(orientation, float)
    length = float(np.linalg.norm(quaternion))
    return matrix_of(quaternion / length) if length > 1e-6 else np.eye(3)


def _beyond_reach(kinematics: ChainKinematics, position: Array, tolerance: Tolerance) -> str:
    """The reason why no posture at all can bring the tip there, or ""."""
    root, length = kinematics.reach()
    distance = float(np.linalg.norm(position - root))
    if distance <= length + tolerance.position:
        return ""
    return f"the target is {distance:.3f} m from the start of the chain, which is {length:.3f} m long"


def _problem(request: IkRequest, body: Body) -> str:
    """The first error in the numbers and names of a request, or ""."""
    if not (np.isfinite(request.position).all() and np.isfinite(request.orientation).all()):
        return "the target holds a number that is not finite"
    if max(np.abs(request.position).max(), np.abs(request.orientation).max()) > FARTHEST:
        return "the target holds a number that is not plausible"
    if np.linalg.norm(request.orientation) < 1e-6 and not request.position_only:
        return "the target's quaternion has length 0"
    for name, position in request.seed.items():
        if name not in body.joints:
            return f"the seed names a joint '{name}' that the robot does not have"
        if not math.isfinite(position):
            return f"the seed of {name} is not finite"
    numbers = (request.position_tolerance, request.orientation_tolerance, request.timeout)
    if not all(math.isfinite(number) and number >= 0 for number in numbers):
        return "tolerances and timeout must be finite and not negative"
    if not 0 <= request.attempts <= _MOST_ATTEMPTS:
        return f"attempts must be 0 to {_MOST_ATTEMPTS}"
    return ""
