"""The dances: a pose for every beat, and steps with some of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..control.posture import posed, relaxed
from ..robot.body import OURS, Body
from ..spatial import Array

_RAISING = ("shoulder_pitch", "elbow")  # what raises and bends an arm


@dataclass(frozen=True, slots=True)
class Beat:
    """The pose of the upper body at the end of a beat, and the steps that begin with the beat.

    `pose` holds the joints that differ from standing relaxed [rad], `squat` the distance by which the pelvis
    is lowered [m]. Each step is (forward, left, turn) of the body, as `footsteps.advance` takes it.
    """

    pose: Mapping[str, float] = field(default_factory=dict)
    squat: float = 0.0
    steps: tuple[tuple[float, float, float], ...] = ()

    def joints(self, body: Body) -> Array:
        """Positions of waist, head and arms, as `body.upper_body`."""
        return posed(body, self.pose, relaxed(body))


@dataclass(frozen=True, slots=True)
class Choreography:
    """A dance: its beats, and its own tempo [1/min]."""

    tempo: float
    beats: tuple[Beat, ...]

    def lacking(self, body: Body) -> str:
        """The joint without which this dance cannot be recognised and that the robot lacks, or ""."""
        used = {name for beat in self.beats for name in beat.pose if name.endswith(_RAISING)}
        return next((name for name in sorted(used) if name not in body.joints), "")


def _both(**left: float) -> dict[str, float]:
    """A pose of both arms, given the pose of the left one."""
    pose = {}
    for name, position in left.items():
        pose["l_" + name] = position
        pose["r_" + name] = -position if name.endswith(("roll", "yaw")) else position
    return pose


def _swapped(beat: Beat) -> Beat:
    """The same beat, mirrored."""
    pose = {}
    for name, position in beat.pose.items():
        other = {"l_": "r_", "r_": "l_"}.get(name[:2], name[:2]) + name[2:]
        pose[other] = -position if name.endswith(("roll", "yaw")) else position
    return Beat(pose, beat.squat, tuple((forward, -left, -turn) for forward, left, turn in beat.steps))


_UP = Beat(_both(shoulder_pitch=-2.6, shoulder_roll=0.4, elbow=-0.4) | {"head_pitch": -0.3})
_OUT = Beat(_both(shoulder_pitch=-0.3, shoulder_roll=1.3, elbow=-0.9), squat=0.05)
_POINT = Beat(
    {
        "l_shoulder_pitch": -2.4, "l_shoulder_roll": 0.7, "l_elbow": -0.1, "r_shoulder_roll": -0.5, "r_elbow":
        -1.4, "waist_yaw": 0.35, "waist_roll": -0.10, "head_yaw": 0.5,
    },
    squat=0.02,
)  # fmt: skip
_LEAN = Beat(
    {"waist_roll": 0.16, "head_yaw": -0.3, "l_shoulder_roll": 0.9, "r_shoulder_roll": -0.3}, squat=0.03
)
_WAVE_IN = Beat({"r_shoulder_pitch": -2.4, "r_shoulder_roll": -0.5, "r_elbow": -0.4, "head_yaw": -0.2})
_WAVE_OUT = Beat({"r_shoulder_pitch": -2.4, "r_shoulder_roll": -0.2, "r_elbow": -1.1, "head_yaw": 0.1})
_HUG = Beat(_both(shoulder_pitch=-1.2, shoulder_roll=0.35, elbow=-1.2))
_TURN = Beat(_HUG.pose, steps=((0.0, 0.0, -0.3),) * 8 + ((0.0, 0.0, 0.0),))
_SIDE = Beat(_HUG.pose, steps=((0.0, -0.06, 0.0), (0.0, 0.0, 0.0), (0.0, -0.06, 0.0), (0.0, 0.0, 0.0)))

DANCES: Mapping[str, Choreography] = {
    "wave": Choreography(100, (_WAVE_IN, _WAVE_OUT) * 4),
    "disco": Choreography(80, (_OUT, _UP, _POINT, _swapped(_POINT), _OUT, _LEAN, _swapped(_LEAN), _UP)),
    "waltz": Choreography(75, (_HUG, _TURN, *(_HUG,) * 13, _SIDE, *(_HUG,) * 6, _OUT)),
}


def blend(start: Array, end: Array, share: float) -> Array:
    """Positions on the way from start to end, at rest at both ends; `share` is 0 to 1."""
    return start + (end - start) * (share**3 * (10 - 15 * share + 6 * share * share))


def standing_posture(body: Body = OURS) -> Array:
    """The posture in which every dance begins and ends, as `body.upper_body`."""
    return relaxed(body)
