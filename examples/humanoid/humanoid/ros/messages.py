"""Messages to plain data and back: the one place that knows both `data.py` and the interfaces."""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from enum import IntEnum
from typing import Any, TypeVar

import numpy as np
from builtin_interfaces.msg import Duration, Time
from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion, Twist, Vector3, Wrench, WrenchStamped
from humanoid_interfaces.msg import EmergencyStop as EmergencyStopMessage
from humanoid_interfaces.msg import Footstep as FootstepMessage
from humanoid_interfaces.msg import FootstepPlan as FootstepPlanMessage
from humanoid_interfaces.msg import GaitState as GaitStateMessage
from humanoid_interfaces.msg import Stance as StanceMessage
from nav_msgs.msg import Odometry as OdometryMessage
from sensor_msgs.msg import BatteryState
from sensor_msgs.msg import Imu as ImuMessage
from sensor_msgs.msg import JointState as JointStateMessage
from std_msgs.msg import Float64MultiArray, Header, MultiArrayDimension

from ..control.posture import relaxed
from ..data import (
    SECOND,
    STEP_TIME,
    Cause,
    EmergencyStop,
    Footstep,
    FootstepPlan,
    FootWrench,
    GaitState,
    Imu,
    JointCommand,
    JointStates,
    Leg,
    Mode,
    Odometry,
    Posture,
    Stance,
    Support,
)
from ..robot import table
from ..robot.body import OURS, Body
from ..simulation.battery import BatteryReading
from ..spatial import Array

Kind = TypeVar("Kind", bound=IntEnum)

_STAMP = "stamp"
_SQUAT = "squat"
_TEXT = 255  # maximum length of a reason
_FAR = 1e4  # m
_MANY = 2**31
_VOLTS = 1000.0
_NOT_FINITE = "holds a number that is not finite"


def time_of(stamp: int) -> Time:
    """Nanoseconds as a Time."""
    return Time(sec=stamp // SECOND, nanosec=stamp % SECOND)


def duration_of(seconds: float) -> Duration:
    """Seconds as a Duration."""
    nanoseconds = round(seconds * SECOND)
    return Duration(sec=nanoseconds // SECOND, nanosec=nanoseconds % SECOND)


def nanoseconds(time: Time | Duration) -> int:
    """A Time or Duration in nanoseconds."""
    return int(time.sec) * SECOND + int(time.nanosec)


def header(stamp: int, frame: str) -> Header:
    """A header."""
    return Header(stamp=time_of(stamp), frame_id=frame)


def point(x: float, y: float, z: float) -> Point:
    """A point; numpy numbers become Python numbers."""
    return Point(x=float(x), y=float(y), z=float(z))


def vector(values: Array) -> Vector3:
    """A vector of three numbers."""
    x, y, z = values.tolist()  # Python numbers, which messages accept faster than numpy's
    return Vector3(x=x, y=y, z=z)


def quaternion(values: Array) -> Quaternion:
    """A quaternion (x, y, z, w)."""
    x, y, z, w = values.tolist()
    return Quaternion(x=x, y=y, z=z, w=w)


def numbers(message: Any) -> Array:
    """The numbers of a Vector3, Point or Quaternion."""
    if type(message) is Quaternion:
        return np.array((message.x, message.y, message.z, message.w), dtype=float)
    return np.array((message.x, message.y, message.z), dtype=float)


def planar_pose(x: float, y: float, yaw: float) -> Pose:
    """A pose on the floor."""
    half = float(yaw) / 2
    orientation = Quaternion(z=math.sin(half), w=math.cos(half))
    return Pose(position=Point(x=float(x), y=float(y)), orientation=orientation)


def place_of(pose: Any) -> tuple[float, float, float]:
    """(x, y, yaw) of a Pose. Raises ValueError if it is nowhere on this floor."""
    x, y, yaw = planar(pose).tolist()
    if not (abs(x) <= _FAR and abs(y) <= _FAR and math.isfinite(yaw)):
        raise ValueError(_beyond(x, y, yaw))
    return x, y, yaw


def _beyond(*numbers: float) -> str:
    return _NOT_FINITE if not all(map(math.isfinite, numbers)) else f"is more than {_FAR:g} m away"


def planar(pose: Any) -> Array:
    """(x, y, yaw) of a Pose, or of a Footstep; a quaternion of zeros counts as no rotation."""
    q = pose.orientation
    yaw = math.atan2(2 * (q.w * q.z + q.x * q.y), q.w * q.w + q.x * q.x - q.y * q.y - q.z * q.z)
    return np.array([pose.position.x, pose.position.y, yaw])


def stamped(stamp: int, pose: Pose) -> PoseStamped:
    """A pose in odom."""
    return PoseStamped(header=header(stamp, "odom"), pose=pose)


def joint_states(states: JointStates, names: Sequence[str] = OURS.joints) -> JointStateMessage:
    """For /joint_encoders and /joint_states."""
    return JointStateMessage(
        header=header(states.stamp, ""),
        name=list(names),
        position=_doubles(states.position),
        velocity=_doubles(states.velocity),
        effort=_doubles(states.effort),
    )


def read_joint_states(message: JointStateMessage, body: Body = OURS) -> JointStates:
    """From /joint_states. Raises ValueError if joints differ from the robot's or values are missing."""
    size = len(body.joints)
    if tuple(message.name) != body.joints:
        raise ValueError(f"expected the {size} joints of the model, in its order")
    parts = [np.array(values, dtype=float) for values in (message.position, message.velocity, message.effort)]
    if any(part.size != size for part in parts):
        raise ValueError(f"expected {size} positions, velocities and efforts")
    return JointStates(nanoseconds(message.header.stamp), parts[0], parts[1], parts[2])


def imu(reading: Imu) -> ImuMessage:
    """For /imu/data."""
    return ImuMessage(
        header=header(reading.stamp, table.IMU_FRAME),
        orientation=quaternion(reading.orientation),
        angular_velocity=vector(reading.angular_velocity),
        linear_acceleration=vector(reading.linear_acceleration),
    )


def read_imu(message: ImuMessage) -> Imu:
    """From /imu/data."""
    return Imu(
        nanoseconds(message.header.stamp),
        numbers(message.orientation),
        numbers(message.angular_velocity),
        numbers(message.linear_acceleration),
    )


def wrench(reading: FootWrench, frame: str) -> WrenchStamped:
    """For /l_foot/wrench and /r_foot/wrench."""
    force_and_torque = Wrench(force=vector(reading.force), torque=vector(reading.torque))
    return WrenchStamped(header=header(reading.stamp, frame), wrench=force_and_torque)


def read_wrench(message: WrenchStamped) -> FootWrench:
    """From /l_foot/wrench and /r_foot/wrench."""
    stamp = nanoseconds(message.header.stamp)
    return FootWrench(stamp, numbers(message.wrench.force), numbers(message.wrench.torque))


def odometry(estimate: Odometry) -> OdometryMessage:
    """For /odom."""
    message = OdometryMessage(header=header(estimate.stamp, "odom"), child_frame_id="base_link")
    message.pose.pose.position = point(*estimate.position.tolist())
    message.pose.pose.orientation = quaternion(estimate.orientation)
    message.twist.twist = Twist(
        linear=vector(estimate.linear_velocity), angular=vector(estimate.angular_velocity)
    )
    return message


def read_odometry(message: OdometryMessage) -> Odometry:
    """From /odom."""
    return Odometry(
        nanoseconds(message.header.stamp),
        numbers(message.pose.pose.position),
        numbers(message.pose.pose.orientation),
        numbers(message.twist.twist.linear),
        numbers(message.twist.twist.angular),
    )


def command(setpoints: JointCommand) -> Float64MultiArray:
    """For /whole_body_position_controller/commands; the stamp goes into a dimension of its own."""
    message = Float64MultiArray(data=_doubles(setpoints.position))
    size = len(setpoints.position)
    seconds, rest = divmod(setpoints.stamp, SECOND)
    message.layout.dim = [
        MultiArrayDimension(label="joints", size=size, stride=size),
        MultiArrayDimension(label=_STAMP, size=seconds, stride=rest),
    ]
    return message


def read_command(message: Float64MultiArray, now: int) -> JointCommand:
    """From /whole_body_position_controller/commands; without a stamp it answers the present moment."""
    stamps = [d.size * SECOND + d.stride for d in message.layout.dim if d.label == _STAMP]
    return JointCommand(stamps[0] if stamps else now, np.array(message.data, dtype=float), bool(stamps))


def joint_commands(setpoints: JointCommand, names: Sequence[str]) -> JointStateMessage:
    """For /joint_commands; the stamp is that of the readings that they answer."""
    return JointStateMessage(
        header=header(setpoints.stamp, ""), name=list(names), position=_doubles(setpoints.position)
    )


def read_joint_commands(message: JointStateMessage, names: Sequence[str]) -> JointCommand:
    """From /joint_commands. Raises ValueError if a joint is missing, or a position."""
    position = np.array(message.position, dtype=float)
    if message.name != list(names):
        values = dict(zip(message.name, message.position, strict=False))
        missing = [name for name in names if name not in values]
        if missing:
            raise ValueError(f"no set-point for {missing[0]}: a servo for each joint of the model needs one")
        position = np.array([values[name] for name in names])
    if position.size != len(names) or not np.isfinite(position).all():
        raise ValueError(f"expected {len(names)} finite positions")
    return JointCommand(nanoseconds(message.header.stamp), position)


def footstep(step: Footstep) -> FootstepMessage:
    """A step of a plan."""
    pose = planar_pose(step.x, step.y, step.yaw)
    return FootstepMessage(
        index=step.index,
        leg=int(step.leg),
        position=pose.position,
        orientation=pose.orientation,
        step_time=duration_of(step.step_time),
    )


def footstep_plan(plan: FootstepPlan, stamp: int) -> FootstepPlanMessage:
    """For /footsteps/plan and /footsteps/upcoming."""
    return FootstepPlanMessage(
        header=header(stamp, "odom"),
        plan_id=plan.plan_id,
        steps=[footstep(step) for step in plan.steps],
        goal=planar_pose(*plan.goal),
    )


def read_footstep_plan(message: FootstepPlanMessage) -> FootstepPlan:
    """From /footsteps/plan and /footsteps/upcoming. Raises ValueError for a step that no leg can take."""
    steps = []
    for number, step in enumerate(message.steps, 1):
        x, y, yaw = planar(step).tolist()
        if step.leg not in (Leg.LEFT, Leg.RIGHT):
            raise ValueError(f"step {number} names no leg")
        if not (abs(x) <= _FAR and abs(y) <= _FAR and math.isfinite(yaw)):
            raise ValueError(f"step {number} {_beyond(x, y, yaw)}")
        check_count(f"the index of step {number}", step.index)
        time = nanoseconds(step.step_time) / SECOND
        steps.append(Footstep(int(step.index), Leg(step.leg), x, y, yaw, time or STEP_TIME))
    check_count("plan_id", message.plan_id)
    x, y, yaw = (float(part) for part in planar(message.goal))
    return FootstepPlan(int(message.plan_id), tuple(steps), (x, y, yaw), nanoseconds(message.header.stamp))


def stance(value: Stance, stamp: int) -> StanceMessage:
    """The places of the soles."""
    left, right = (planar_pose(*foot.tolist()) for foot in value.feet)
    return StanceMessage(
        header=header(stamp, "odom"), support=int(value.support), left_sole=left, right_sole=right
    )


def read_stance(message: StanceMessage) -> Stance:
    """The places of the soles. Raises ValueError if they are nowhere on this floor."""
    feet = []
    for side, pose in (("left", message.left_sole), ("right", message.right_sole)):
        try:
            feet.append(np.array(place_of(pose)))
        except ValueError as error:
            raise ValueError(f"the {side} sole {error}") from None
    return Stance(_known(Support, message.support), (feet[0], feet[1]))


def gait_state(state: GaitState) -> GaitStateMessage:
    """For /gait_state."""
    return GaitStateMessage(
        header=header(state.stamp, "odom"),
        mode=int(state.mode),
        reason=state.reason[:_TEXT],
        stance=stance(state.stance, state.stamp),
        plan_id=state.plan_id,
        footstep_index=state.footstep_index,
        phase=float(state.phase),
    )


def read_gait_state(message: GaitStateMessage) -> GaitState:
    """From /gait_state. Raises ValueError for values that no controller reports."""
    check_count("plan_id", message.plan_id)
    check_count("footstep_index", message.footstep_index)
    return GaitState(
        nanoseconds(message.header.stamp),
        _known(Mode, message.mode),
        printable(message.reason),
        read_stance(message.stance),
        int(message.plan_id),
        int(message.footstep_index),
        float(message.phase),
    )


def posture(value: Posture | None, stamp: int, body: Body = OURS) -> JointStateMessage:
    """For /posture; without names it ends the request for a posture."""
    if value is None:
        return JointStateMessage(header=header(stamp, ""))
    names, positions = [*body.upper_body, _SQUAT], _doubles([*value.position, value.squat])
    return JointStateMessage(header=header(stamp, ""), name=names, position=positions)


def read_posture(message: JointStateMessage, body: Body = OURS) -> Posture | None:
    """From /posture; joints that it does not name stay as they are when the robot stands.

    Raises ValueError for joints that are not of the upper body, and for names without a position.
    """
    if not message.name:
        return None
    if len(message.position) != len(message.name):
        raise ValueError(f"{len(message.name)} joints, but {len(message.position)} positions")
    values = dict(zip(message.name, message.position, strict=True))
    squat = values.pop(_SQUAT, 0.0)
    usual = dict(zip(body.upper_body, relaxed(body).tolist(), strict=True))
    if unknown := [name for name in values if name not in usual]:
        raise ValueError(f"the robot has no joint '{unknown[0]}' in waist, head and arms")
    return Posture(np.array(list((usual | values).values())), squat)


def emergency_stop(status: EmergencyStop) -> EmergencyStopMessage:
    """For /emergency_stop."""
    return EmergencyStopMessage(
        header=header(status.stamp, ""),
        active=status.active,
        cause=int(status.cause),
        source=status.source[:128],
        reason=status.reason[:_TEXT],
    )


def read_emergency_stop(message: EmergencyStopMessage) -> EmergencyStop:
    """From /emergency_stop."""
    stamp = nanoseconds(message.header.stamp)
    source, reason = printable(message.source), printable(message.reason)
    return EmergencyStop(message.active, _known(Cause, message.cause), source, reason, stamp)


def printable(text: str) -> str:
    """Text of others for a terminal: what would move its cursor, or change its colours, is written out."""
    return text if text.isprintable() else "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def read_battery_state(message: BatteryState) -> BatteryReading:
    """From /battery_state. Raises ValueError for a battery that cannot be."""
    if not 0.0 <= message.percentage <= 1.0:
        raise ValueError(f"the charge is {message.percentage:g}, and must be from 0 to 1")
    if not 0.0 < message.voltage < _VOLTS:
        raise ValueError(f"{message.voltage:g} V is not plausible")
    stamp = nanoseconds(message.header.stamp)
    return BatteryReading(stamp, message.voltage, message.current, message.percentage, message.temperature)


def check_count(name: str, value: int) -> None:
    """Raise ValueError for a number that nobody has counted to: the next one would not fit into a field."""
    if value >= _MANY:
        raise ValueError(f"{name} is {value}, which is not plausible")


def _known(kind: type[Kind], value: int) -> Kind:
    """A value of an enumeration whose 0 means unknown: a message may hold numbers that have no name."""
    try:
        return kind(value)
    except ValueError:
        return kind(0)


def _doubles(values: Array | Sequence[float]) -> array[float]:
    """An array of doubles, as a `float64[]` field holds it: adopted without a check of each value."""
    return array("d", np.ascontiguousarray(values, dtype=float).tobytes())
