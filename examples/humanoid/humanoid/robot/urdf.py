"""The table as URDF, for robot_description: the same links, joints, masses and frames as in the MJCF.

URDF has no capsules and no ellipsoids. Capsules collide as cylinders of the same length, ellipsoids as
spheres, and both look like several shapes; masses and inertias are theirs. The floating joint of base_link
and the servos have no place in URDF.
"""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np

from ..spatial import Array
from . import table
from .xmltext import add, document

TOP_SPEED = 20.0  # rad/s; URDF requires one


def write_urdf() -> str:
    """Return the robot as URDF text."""
    root = ElementTree.Element("robot", name=table.NAME)
    for link in table.LINKS:
        _link(root, link)
        if link.joint is not None:
            joint = add(root, "joint", name=link.joint.name, type="revolute")
            _place(joint, link.parent, link.name, link.origin)
            add(joint, "axis", xyz=link.joint.axis)
            limits = {"lower": link.joint.lower, "upper": link.joint.upper, "effort": link.joint.effort}
            add(joint, "limit", velocity=TOP_SPEED, **limits)
            add(joint, "dynamics", damping=0.3, friction=0.05)
    for frame in table.FRAMES:
        add(root, "link", name=frame.name)
        joint = add(root, "joint", name=f"{frame.name}_fixed", type="fixed")
        _place(joint, frame.link, frame.name, frame.origin, frame.rpy)
    return document(root)


def _place(
    joint: ElementTree.Element,
    parent: str,
    child: str,
    origin: table.Vector,
    rpy: table.Vector = (0.0, 0.0, 0.0),
) -> None:
    add(joint, "parent", link=parent)
    add(joint, "child", link=child)
    add(joint, "origin", xyz=origin, rpy=rpy)


def _link(root: ElementTree.Element, link: table.Link) -> None:
    element = add(root, "link", name=link.name)
    mass, centre, inertia = link_inertia(link)
    inertial = add(element, "inertial")
    add(inertial, "origin", xyz=tuple(map(float, centre)), rpy=(0.0, 0.0, 0.0))
    add(inertial, "mass", value=mass)
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = inertia.tolist()
    add(inertial, "inertia", ixx=xx, ixy=xy, ixz=xz, iyy=yy, iyz=yz, izz=zz)
    for shape in link.shapes:
        for part in looks(shape):
            geometry(_coloured(element, part), part)
        collision = add(element, "collision")
        add(collision, "origin", xyz=shape.position, rpy=(0.0, 0.0, 0.0))
        geometry(add(collision, "geometry"), shape)


def _coloured(link: ElementTree.Element, shape: table.Shape) -> ElementTree.Element:
    """A visual at the place and in the colour of a shape; returns its geometry."""
    visual = add(link, "visual")
    add(visual, "origin", xyz=shape.position, rpy=(0.0, 0.0, 0.0))
    geometry = add(visual, "geometry")
    material = add(visual, "material", name="colour_" + "_".join(f"{c * 255:.0f}" for c in shape.colour))
    add(material, "color", rgba=(*shape.colour, 1.0))
    return geometry


def looks(shape: table.Shape) -> list[table.Shape]:
    """The shapes to show for one: a capsule with its round ends, which a high ellipsoid looks like, too."""
    x, y, z = shape.size
    if shape.kind == "ellipsoid" and z > (radius := (x + y) / 2):
        shape = replace(shape, kind="capsule", size=(radius, z - radius, 0.0))
    if shape.kind != "capsule":
        return [shape]
    radius, half, _ = shape.size
    x, y, z = shape.position
    ball = replace(shape, kind="sphere", size=(radius, 0.0, 0.0))
    return [shape, *(replace(ball, position=(x, y, z + end)) for end in (-half, half))]


def geometry(parent: ElementTree.Element, shape: table.Shape) -> None:
    """A shape without its position. An ellipsoid becomes a sphere with the radius of its middle half axis."""
    if shape.kind == "box":
        add(parent, "box", size=tuple(2 * half for half in shape.size))
    elif shape.kind == "capsule":
        add(parent, "cylinder", radius=shape.size[0], length=2 * shape.size[1])
    else:
        radius = sorted(shape.size)[1] if shape.kind == "ellipsoid" else shape.size[0]
        add(parent, "sphere", radius=radius)


def link_inertia(link: table.Link) -> tuple[float, Array, Array]:
    """Mass, centre (3,) and inertia about it (3, 3) of a link, in its axes."""
    mass = sum(shape.mass for shape in link.shapes)
    centre = sum((shape.mass * np.array(shape.position) for shape in link.shapes), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for shape in link.shapes:
        away = np.array(shape.position) - centre
        moved = shape.mass * (away @ away * np.eye(3) - np.outer(away, away))
        inertia += np.diag(_inertia(shape)) + moved
    return mass, centre, inertia


def _inertia(shape: table.Shape) -> tuple[float, float, float]:
    """The moments of inertia of a shape about its own axes."""
    x, y, z = shape.size
    if shape.kind == "box":
        third = shape.mass / 3
        return third * (y * y + z * z), third * (x * x + z * z), third * (x * x + y * y)
    if shape.kind == "ellipsoid":
        fifth = shape.mass / 5
        return fifth * (y * y + z * z), fifth * (x * x + z * z), fifth * (x * x + y * y)
    radius, half = x, y if shape.kind == "capsule" else 0.0
    # A cylinder and its two hemispherical ends share the mass in proportion to their volumes.
    ball = shape.mass * (4 / 3 * radius) / (4 / 3 * radius + 2 * half)
    tube = shape.mass - ball
    along = 0.4 * ball * radius**2 + 0.5 * tube * radius**2
    across = (
        tube * (radius**2 / 4 + half**2 / 3)
        + ball * (0.4 * radius**2 + half**2 + 0.75 * radius * half)
    )  # fmt: skip
    return across, across, along
