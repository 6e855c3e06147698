"""Bodies that differ from ours, derived from it: somebody else's robots, as MJCF text."""

from __future__ import annotations

from xml.etree import ElementTree

from humanoid.robot.mjcf import write_mjcf


def shorter_legs(share: float) -> str:
    """Our robot with thighs and shins shorter by a share of their length."""
    root = ElementTree.fromstring(write_mjcf())
    for body in root.iter("body"):
        name = body.attrib["name"].partition("_")[2]
        if name in ("shin", "ankle_link"):  # their places are where the thigh and the shin end
            _scale(body, "pos", 2, 1 - share)
        if name in ("thigh", "shin"):
            for geom in body.findall("geom"):
                _scale(geom, "pos", 2, 1 - share)
                _scale(geom, "size", 1, 1 - share)
    return ElementTree.tostring(root, encoding="unicode")


def _scale(element: ElementTree.Element, key: str, place: int, factor: float) -> None:
    numbers = [float(part) for part in element.attrib[key].split()]
    numbers[place] *= factor
    element.set(key, " ".join(map(repr, numbers)))


def offset_hips() -> str:
    """A robot whose hip axes pass each other at a distance, with other axes first, 7-joint arms with a finger, no neck.

    The hip turns about y, then x, then z, as many robots' do; each axis is centimetres from the one before.
    The ankle's axes do not meet either.
    """
    root = ElementTree.fromstring(write_mjcf())
    bodies = {body.attrib["name"]: body for body in root.iter("body")}
    for side, sign in (("l", 1.0), ("r", -1.0)):
        yaw, roll, thigh = (bodies[f"{side}_{link}"] for link in ("hip_yaw_link", "hip_roll_link", "thigh"))
        joints = [_joint(body) for body in (yaw, roll, thigh)]
        for body, joint in zip((yaw, roll, thigh), reversed(joints), strict=True):
            body.remove(_joint(body))
            body.insert(0, joint)
        yaw.set("pos", f"0.0 {sign * 0.07} -0.05")
        roll.set("pos", f"-0.04 {sign * 0.035} -0.02")
        thigh.set("pos", f"0.03 {sign * 0.005} -0.06")
        bodies[f"{side}_shin"].set("pos", f"0.01 {-sign * 0.002} -0.24")
        bodies[f"{side}_ankle"].set("pos", "0.0 0.0 -0.015")
        wrist = bodies[f"{side}_wrist"]
        hand = ElementTree.SubElement(wrist, "body", name=f"{side}_hand", pos="0.0 0.0 -0.02")
        seventh = {"axis": "1.0 0.0 0.0", "range": "-0.8 0.8", "armature": "0.005"}
        ElementTree.SubElement(hand, "joint", name=f"{side}_wrist_yaw", **seventh)
        for geom in wrist.findall("geom"):
            wrist.remove(geom)
            hand.append(geom)
        ElementTree.SubElement(wrist, "geom", type="sphere", size="0.02", mass="0.05")
        finger = ElementTree.SubElement(hand, "body", name=f"{side}_finger", pos="0.03 0.0 -0.1")
        ElementTree.SubElement(finger, "joint", name=f"{side}_grip", type="slide", range="-0.01 0.01")
        ElementTree.SubElement(finger, "geom", type="sphere", size="0.01", mass="0.02")
    neck = bodies["neck"]
    bodies["torso"].remove(neck)
    for tag in ("actuator", "sensor"):  # they are somebody else's, and replaced
        root.remove(root.find(tag) or ElementTree.Element(""))
    return ElementTree.tostring(root, encoding="unicode")


def only_legs() -> str:
    """Two legs and a pelvis, as heavy as the rest of our robot: nothing above them moves."""
    root = ElementTree.fromstring(write_mjcf())
    base = next(body for body in root.iter("body") if body.attrib["name"] == "base_link")
    for body in base.findall("body"):
        if "hip" not in body.attrib["name"]:
            base.remove(body)
    trunk = {"type": "box", "size": "0.07 0.11 0.2", "pos": "0.0 0.0 0.26", "mass": "16.0"}
    ElementTree.SubElement(base, "geom", **trunk)
    for tag in ("actuator", "sensor"):
        root.remove(root.find(tag) or ElementTree.Element(""))
    return ElementTree.tostring(root, encoding="unicode")


def _joint(body: ElementTree.Element) -> ElementTree.Element:
    joint = body.find("joint")
    assert joint is not None
    return joint
