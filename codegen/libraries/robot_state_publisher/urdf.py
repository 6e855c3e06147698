"""Robots in URDF: their links, and the joints between them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final
from xml.etree import ElementTree

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
"""x, y, z, w."""

MOVING: Final = ("revolute", "continuous", "prismatic")
"""The types of joints with one position."""
_TYPES: Final = (*MOVING, "fixed", "floating", "planar")


class UrdfError(ValueError):
    """A text that describes no robot; it says why."""


@dataclass(frozen=True, slots=True)
class Mimic:
    """A joint that follows another one: its position is `multiplier` times that one's, plus `offset`."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint: the pose of its child at position 0, and the axis that it moves along or around."""

    name: str
    type: str
    parent: str
    child: str
    translation: Vector
    rotation: Quaternion
    axis: Vector
    lower: float
    """Limits [rad or m]; those of a continuous joint are -pi and pi."""
    upper: float
    soft_lower: float
    """Limits that a safety controller keeps [rad or m]; infinite if there is none."""
    soft_upper: float
    mimic: Mimic | None

    def pose(self, position: float) -> tuple[Vector, Quaternion]:
        """Return the pose of the child in the parent at a position [rad or m]."""
        if self.type == "prismatic":
            x, y, z = rotated(self.rotation, _scaled(self.axis, position))
            at = self.translation
            return (at[0] + x, at[1] + y, at[2] + z), self.rotation
        if self.type in {"revolute", "continuous"}:
            half = position / 2
            x, y, z = _scaled(self.axis, math.sin(half))
            return self.translation, product(self.rotation, (x, y, z, math.cos(half)))
        return self.translation, self.rotation


@dataclass(frozen=True, slots=True)
class Robot:
    """A tree of links; `joints` are in the order of the text, by name."""

    name: str
    root: str
    joints: Mapping[str, Joint]

    def with_mimics(self, positions: Mapping[str, float]) -> dict[str, float]:
        """Return positions, and those of the joints that follow one of them."""
        found = dict(positions)
        for name, joint in self.joints.items():
            if joint.mimic is not None and joint.mimic.joint in positions:
                found[name] = positions[joint.mimic.joint] * joint.mimic.multiplier + joint.mimic.offset
        return found


def read_urdf(text: str) -> Robot:
    """Return the robot that a text describes. Raises UrdfError."""
    if not text.strip():
        raise UrdfError("the robot description is empty")
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise UrdfError(f"the robot description is not XML: {error}") from None
    if root.tag != "robot":
        raise UrdfError(f"the outermost element of a robot description must be 'robot', got '{root.tag}'")
    links = [_needed(link, "name", "a link") for link in root.findall("link")]
    if not links:
        raise UrdfError("the robot has no link")
    joints: dict[str, Joint] = {}
    for element in root.findall("joint"):
        joint = _joint(element)
        if joint.name in joints:
            raise UrdfError(f"the robot has two joints '{joint.name}'")
        joints[joint.name] = joint
    for name in {name for name in links if links.count(name) > 1}:
        raise UrdfError(f"the robot has two links '{name}'")
    return Robot(root.get("name", ""), _root(set(links), links, joints), joints)


def _root(known: set[str], links: list[str], joints: Mapping[str, Joint]) -> str:
    """Return the link that is no child. Raises UrdfError unless the joints make a tree."""
    parents: dict[str, str] = {}
    for joint in joints.values():
        for link in (joint.parent, joint.child):
            if link not in known:
                raise UrdfError(f"the joint '{joint.name}' names the link '{link}', which is not there")
        if joint.child in parents:
            raise UrdfError(f"the link '{joint.child}' is the child of two joints")
        if joint.mimic is not None and joint.mimic.joint not in joints:
            raise UrdfError(f"the joint '{joint.name}' follows '{joint.mimic.joint}', which is no joint")
        parents[joint.child] = joint.parent
    roots = [link for link in links if link not in parents]
    if len(roots) != 1:
        found = ", ".join(f"'{root}'" for root in roots) or "none"
        raise UrdfError(f"the links of a robot must make one tree, with one root; there are {found}")
    for link in links:
        steps = 0
        at = link
        while at in parents:
            at, steps = parents[at], steps + 1
            if steps > len(links):
                raise UrdfError(f"the joints around the link '{link}' make a circle")
    return roots[0]


def _joint(element: ElementTree.Element) -> Joint:
    name = _needed(element, "name", "a joint")
    what = f"the joint '{name}'"
    kind = _needed(element, "type", what)
    if kind not in _TYPES:
        raise UrdfError(f"{what} has the type '{kind}', expected one of {', '.join(_TYPES)}")
    origin, axis, limit, mimic = (element.find(tag) for tag in ("origin", "axis", "limit", "mimic"))
    direction = _vector(axis, "xyz", what, (1.0, 0.0, 0.0))
    length = math.hypot(*direction)
    if kind in MOVING and not length:
        raise UrdfError(f"{what} has an axis of length 0")
    if kind in {"revolute", "prismatic"} and limit is None:
        raise UrdfError(f"{what} of type {kind} needs a 'limit'")
    is_free = kind == "continuous"
    safety = element.find("safety_controller")
    return Joint(
        name=name,
        type=kind,
        parent=_link(element, "parent", what),
        child=_link(element, "child", what),
        translation=_vector(origin, "xyz", what, (0.0, 0.0, 0.0)),
        rotation=from_rpy(*_vector(origin, "rpy", what, (0.0, 0.0, 0.0))),
        axis=_scaled(direction, 1 / length) if length else direction,
        lower=-math.pi if is_free else _number(limit, "lower", what, 0.0),
        upper=math.pi if is_free else _number(limit, "upper", what, 0.0),
        soft_lower=_number(safety, "soft_lower_limit", what, -math.inf),
        soft_upper=_number(safety, "soft_upper_limit", what, math.inf),
        mimic=None
        if mimic is None
        else Mimic(
            _needed(mimic, "joint", f"'mimic' of {what}"),
            _number(mimic, "multiplier", what, 1.0),
            _number(mimic, "offset", what, 0.0),
        ),
    )


def _needed(element: ElementTree.Element, attribute: str, what: str) -> str:
    value = element.get(attribute)
    if not value:
        raise UrdfError(f"{what} needs the attribute '{attribute}'")
    return value


def _link(element: ElementTree.Element, tag: str, what: str) -> str:
    inside = element.find(tag)
    if inside is None:
        raise UrdfError(f"{what} needs a '{tag}'")
    return _needed(inside, "link", f"'{tag}' of {what}")


def _vector(element: ElementTree.Element | None, name: str, what: str, default: Vector) -> Vector:
    text = None if element is None else element.get(name)
    if text is None:
        return default
    try:
        x, y, z = (float(part) for part in text.split())
    except ValueError:
        raise UrdfError(f"'{name}' of {what} must be three numbers, got '{text}'") from None
    return x, y, z


def _number(element: ElementTree.Element | None, name: str, what: str, default: float) -> float:
    text = None if element is None else element.get(name)
    try:
        return default if text is None else float(text)
    except ValueError:
        raise UrdfError(f"'{name}' of {what} must be a number, got '{text}'") from None


def _scaled(vector: Vector, factor: float) -> Vector:
    return vector[0] * factor, vector[1] * factor, vector[2] * factor


def from_rpy(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return a rotation about the fixed axes x, y and z, in this order [rad]."""
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(a / 2), math.cos(a / 2)) for a in (roll, pitch, yaw))
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )


def product(first: Quaternion, then: Quaternion) -> Quaternion:
    """Return a rotation within another one."""
    ax, ay, az, aw = first
    bx, by, bz, bw = then
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def rotated(rotation: Quaternion, vector: Vector) -> Vector:
    """Return a vector after a rotation."""
    x, y, z, w = rotation
    back = (-x, -y, -z, w)
    found = product(product(rotation, (*vector, 0.0)), back)
    return found[0], found[1], found[2]
