"""The table as MJCF: the robot, the floor that it stands on, and its sensors.

The text uses only what MuJoCo has had since 3.0, so that it loads in any later version. Frames become sites.
MuJoCo's camera looks along -z, so it is turned by half a turn about x in its optical frame.
"""

from __future__ import annotations

from math import pi
from xml.etree import ElementTree

from . import table
from .scene import add_scene
from .xmltext import add, document

STANDING_HEIGHT = 0.80  # of base_link when the simulation starts: slightly above standing
TIMESTEP = 0.002  # of the simulation, seconds

# Who touches whom, as bits of MuJoCo's contype and conaffinity. Links of one limb overlap where they are
# joined, and do not touch each other.
_WORLD, _TRUNK = 1, 2
_LEGS = {"l": 4, "r": 8}
_FOREARMS = {"l": 16, "r": 32}
_FOREARM = {"forearm", "wrist_roll_link", "wrist"}
_UPPER_ARM = {"shoulder_pitch_link", "shoulder_roll_link", "upper_arm"}
_FRICTION = "1.0 0.02 0.001"


def write_mjcf(timestep: float = TIMESTEP) -> str:
    """Return the robot in its scene as MJCF text."""
    root = ElementTree.Element("mujoco", model=table.NAME)
    add(root, "compiler", angle="radian", eulerseq="XYZ", autolimits="true")
    add(root, "option", timestep=timestep, integrator="implicitfast", cone="pyramidal")
    default = add(root, "default")
    add(default, "joint", damping=0.3, frictionloss=0.05)
    add(default, "geom", contype=0, conaffinity=_WORLD, friction=_FRICTION)
    world = add_scene(root)
    bodies = {"": world}
    actuator = ElementTree.Element("actuator")
    for link in table.LINKS:
        bodies[link.name] = body = _body(bodies[link.parent], link)
        for frame in table.FRAMES:
            if frame.link == link.name:
                _frame(body, frame)
        if link.joint is not None:
            _joint(body, actuator, link.joint)
    root.append(actuator)
    _sensors(root)
    return document(root)


def _touches(link: str) -> dict[str, int]:
    """The bits of a link."""
    both_forearms = sum(_FOREARMS.values())
    side, _, part = link.partition("_")
    if side not in _LEGS:
        return {"contype": _TRUNK, "conaffinity": _WORLD | both_forearms}
    other = "r" if side == "l" else "l"
    if part in _FOREARM:
        return {"contype": _FOREARMS[side], "conaffinity": _WORLD | _FOREARMS[other]}
    if part in _UPPER_ARM:
        return {"contype": 0, "conaffinity": _WORLD | _FOREARMS[other]}
    return {"contype": _LEGS[side], "conaffinity": _WORLD | _LEGS[other] | both_forearms}


def _body(parent: ElementTree.Element, link: table.Link) -> ElementTree.Element:
    base = link.joint is None
    body = add(parent, "body", name=link.name, pos=(0.0, 0.0, STANDING_HEIGHT) if base else link.origin)
    if base:
        add(body, "freejoint", name="floating_base")
    for shape in link.shapes:
        size = shape.size[: {"box": 3, "ellipsoid": 3, "capsule": 2, "sphere": 1}[shape.kind]]
        geom = add(
            body,
            "geom",
            type=shape.kind,
            size=size,
            pos=shape.position,
            mass=shape.mass,
            rgba=(*shape.colour, 1),
            **_touches(link.name),
        )
        if shape.name:
            geom.set("name", shape.name)
            geom.set("solref", "0.01 1")  # feet are harder than MuJoCo's default
    return body


def _joint(body: ElementTree.Element, actuator: ElementTree.Element, joint: table.Joint) -> None:
    limits = {"range": (joint.lower, joint.upper)}
    effort = (-joint.effort, joint.effort)
    add(
        body,
        "joint",
        name=joint.name,
        axis=joint.axis,
        armature=joint.armature,
        actuatorfrcrange=effort,
        **limits,
    )
    add(actuator, "position", name=joint.name, joint=joint.name, kp=joint.kp, kv=joint.kv, forcerange=effort)


def _frame(body: ElementTree.Element, frame: table.Frame) -> None:
    roll, pitch, yaw = frame.rpy
    # MuJoCo's euler="XYZ" turns about the axes of the outer frame in that order, as URDF does.
    add(body, "site", name=frame.name, pos=frame.origin, euler=(roll, pitch, yaw))
    if frame.name == table.CAMERA_FRAME:
        add(
            body,
            "camera",
            name="head_camera",
            pos=frame.origin,
            euler=(roll + pi, pitch, yaw),
            fovy=table.CAMERA_FOVY,
        )
    if frame.name.endswith("_sole"):
        half = (table.FOOT_LENGTH / 2 + 0.01, table.FOOT_WIDTH / 2 + 0.01, 0.02)
        pos = (table.FOOT_CENTRE, 0.0, frame.origin[2])
        add(body, "site", name=frame.name + "_touch", type="box", size=half, pos=pos, rgba=(0, 0, 0, 0))
        add(body, "site", name=frame.link)  # where the ankle's force sensor measures


def _sensors(root: ElementTree.Element) -> None:
    sensor = add(root, "sensor")
    add(sensor, "framequat", name="imu_orientation", objtype="site", objname=table.IMU_FRAME)
    add(sensor, "gyro", name="imu_angular_velocity", site=table.IMU_FRAME)
    add(sensor, "accelerometer", name="imu_linear_acceleration", site=table.IMU_FRAME)
    for side in table.SIDES:
        add(sensor, "force", name=f"{side}_foot_force", site=f"{side}_ankle")
        add(sensor, "torque", name=f"{side}_foot_torque", site=f"{side}_ankle")
        add(sensor, "touch", name=f"{side}_foot_touch", site=f"{side}_sole_touch")
