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
