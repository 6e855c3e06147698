"""The data that nodes exchange: plain classes, each carried by a message of the same meaning.

Times are integer nanoseconds of simulated time. Arrays over joints are in the order of the robot's
`Body.joints`, for ours 29. Quaternions are (x, y, z, w). Planar poses are (x, y, yaw) on the floor. World
means the frame odom.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np

from .spatial import Array

SECOND = 1_000_000_000
STOP_CALLED = "somebody called ~/stop"
"""The reason of a controller that holds because it was asked to: it waits for new footsteps."""
STEP_TIME = 0.6  # seconds from lift-off to touchdown, unless another time is requested


class Leg(IntEnum):
    """A leg, as in Footstep.msg."""

    LEFT = 1
    RIGHT = 2

    @property
    def other(self) -> Leg:
        """The other leg."""
        return Leg(3 - self)

    @property
    def side(self) -> int:
        """0 for left, 1 for right: the index into pairs such as the two sole poses."""
        return self - 1

    @property
    def sign(self) -> int:
        """The sideways direction that is outwards: 1 for left, -1 for right."""
        return 3 - 2 * self


class Support(IntEnum):
    """The soles that carry the robot, as in Stance.msg."""

    UNKNOWN = 0
    LEFT = 1
    RIGHT = 2
    BOTH = 3
    NONE = 4


class Mode(IntEnum):
    """The mode of the whole-body controller, as in GaitState.msg."""

    UNKNOWN = 0
    STANDING = 1
    WALKING = 2
    STOPPING = 3
    DANCING = 4
    HOLDING = 5
    FALLEN = 6
    EMERGENCY_STOP = 7


class Cause(IntEnum):
    """The cause of an emergency stop, as in EmergencyStop.msg."""

    UNKNOWN = 0
    OPERATOR = 1
    FALL = 2
    BATTERY = 3
    FAULT = 4
    LIMIT = 5


@dataclass(slots=True)
class JointStates:
    """sensor_msgs/JointState: positions in rad, velocities in rad/s, efforts in N m, each (joints,)."""

    stamp: int
    position: Array
    velocity: Array
    effort: Array


@dataclass(slots=True)
class Imu:
    """sensor_msgs/Imu: orientation, angular velocity and acceleration (gravity included) of imu_link."""

    stamp: int
    orientation: Array  # (4,)
    angular_velocity: Array  # (3,) rad/s, in imu_link
    linear_acceleration: Array  # (3,) m/s2, in imu_link; standing still: 9.81 upwards


@dataclass(slots=True)
class FootWrench:
    """geometry_msgs/WrenchStamped in l_ankle or r_ankle: the wrench of the ground on the foot, z up."""

    stamp: int
    force: Array  # (3,) N
    torque: Array  # (3,) N m


@dataclass(slots=True)
class Sensors:
    """The sensor values that the simulator publishes at every control tick, one message per part."""

    stamp: int
    joints: JointStates
    imu: Imu
    wrenches: tuple[FootWrench, FootWrench]  # left, right
    contacts: tuple[bool, bool]  # std_msgs/Bool


@dataclass(slots=True)
class Odometry:
    """nav_msgs/Odometry: pose of base_link in odom; the twist is in base_link, as that message defines it."""

    stamp: int
    position: Array  # (3,)
    orientation: Array  # (4,)
    linear_velocity: Array  # (3,)
    angular_velocity: Array  # (3,)


@dataclass(slots=True)
class JointCommand:
    """std_msgs/Float64MultiArray for the servos: set-points in rad (joints,), and the tick they answer."""

    stamp: int
    position: Array
    answers: bool = True  # False if the command names no tick; the stamp is then the time of arrival


@dataclass(slots=True)
class Posture:
    """Set-points of waist, head and arms in rad, as `Body.upper_body`, and a lower pelvis."""

    position: Array
    squat: float = 0.0  # distance by which the pelvis is lowered, metres


@dataclass(frozen=True, slots=True)
class Footstep:
    """Footstep.msg on a flat floor: where the sole of `leg` lands, as planar pose of l_sole or r_sole."""

    index: int
    leg: Leg
    x: float
    y: float
    yaw: float
    step_time: float = STEP_TIME  # from lift-off to touchdown, seconds

    @property
    def pose(self) -> Array:
        """(x, y, yaw) as an array."""
        return np.array([self.x, self.y, self.yaw])


@dataclass(frozen=True, slots=True)
class FootstepPlan:
    """FootstepPlan.msg: the remaining steps, soonest first; without steps: stay."""

    plan_id: int
    steps: tuple[Footstep, ...]
    goal: tuple[float, float, float]  # planar pose of base_footprint after the last step
    stamp: int = 0


@dataclass(slots=True)
class Stance:
    """Stance.msg on a flat floor: planar poses of both soles (left, right), and which of them carry."""

    support: Support
    feet: tuple[Array, Array]

    @property
    def centre(self) -> Array:
        """Planar pose of base_footprint: between the soles, turned by the mean of their yaws."""
        left, right = self.feet
        yaw = left[2] + 0.5 * float(np.arctan2(np.sin(right[2] - left[2]), np.cos(right[2] - left[2])))
        return np.array([(left[0] + right[0]) / 2, (left[1] + right[1]) / 2, yaw])


@dataclass(frozen=True, slots=True)
class BalanceState:
    """BalanceState.msg: how the robot keeps its balance, in odom, metres."""

    stamp: int
    centre_of_mass: Array  # (3,)
    capture_point: Array  # (2,)
    zero_moment_point: Array  # (2,)
    support: Array  # (n, 2)


@dataclass(slots=True)
class GaitState:
    """GaitState.msg: the state of the whole-body controller at a control tick."""

    stamp: int
    mode: Mode
    reason: str
    stance: Stance
    plan_id: int
    footstep_index: int
    phase: float


@dataclass(frozen=True, slots=True)
class EmergencyStop:
    """EmergencyStop.msg: while active it overrides every other command."""

    active: bool
    cause: Cause = Cause.UNKNOWN
    source: str = ""
    reason: str = ""
    stamp: int = field(default=0, compare=False)
