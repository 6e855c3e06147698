"""Messages as tables in notebooks."""

from __future__ import annotations

from collections.abc import Iterator
from html import unescape
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import pytest

from .support import imported_from

GENERATED = Path(__file__).resolve().parents[2] / "generated"
PACKAGES = (
    "sensor_msgs",
    "geometry_msgs",
    "nav_msgs",
    "visualization_msgs",
    "std_msgs",
    "builtin_interfaces",
)


@pytest.fixture(scope="module")
def msg() -> Iterator[SimpleNamespace]:
    with imported_from(GENERATED, PACKAGES):
        modules = [import_module(f"{package}.msg") for package in PACKAGES]
        yield SimpleNamespace(**{name: getattr(module, name) for module in modules for name in dir(module)})


def rows(html: str) -> list[list[str]]:
    """The cells of the table's body, with two spaces for a step of its indentation."""
    table = ElementTree.fromstring(html.replace("&emsp;", "  "))
    return [[cell.text or "" for cell in row] for row in table.findall("tbody/tr")]


def test_small_messages_take_a_line(msg: SimpleNamespace) -> None:
    pose = msg.PoseStamped()
    pose.header.stamp.sec, pose.pose.position.x = 3, 0.1
    assert rows(pose._repr_html_()) == [
        ["header", "", "std_msgs/Header"],
        ["  stamp", "sec: 3, nanosec: 0", "builtin_interfaces/Time"],
        ["  frame_id", "''", "string"],
        ["pose", "", "geometry_msgs/Pose"],
        ["  position", "x: 0.1, y: 0.0, z: 0.0", "geometry_msgs/Point"],
        ["  orientation", "x: 0.0, y: 0.0, z: 0.0, w: 1.0", "geometry_msgs/Quaternion"],
    ]
    assert "<caption>geometry_msgs/msg/PoseStamped</caption>" in pose._repr_html_()


def test_texts_are_escaped_and_cut(msg: SimpleNamespace) -> None:
    html = msg.String(data="<script>alert('x')</script>" + "a" * 1000)._repr_html_()
    assert "<script>" not in html
    assert "&lt;script&gt;" in html
    assert len(unescape(html)) < 300


def test_sequences_show_their_beginning_and_size(msg: SimpleNamespace) -> None:
    joints = msg.JointState(name=["a", "b"], position=[0.1] * 29)
    cells = {name: value for name, value, _ in rows(joints._repr_html_())}
    assert cells["name"] == "['a', 'b']"
    assert cells["position"] == f"[{'0.1, ' * 9}…] (29 elements)"
    assert cells["velocity"] == "[]"
    imu = {name: value for name, value, _ in rows(msg.Imu()._repr_html_())}
    assert imu["orientation_covariance"] == f"[{', '.join(['0.0'] * 9)}]"


def test_long_messages_are_cut(msg: SimpleNamespace) -> None:
    path = rows(msg.Path(poses=[msg.PoseStamped() for _ in range(5)])._repr_html_())
    assert ["poses", "5 elements", "sequence<geometry_msgs/PoseStamped>"] in path
    assert [name for name, *_ in path if name.startswith("  [")] == ["  [0]", "  [1]", "  [2]"]
    assert path[-1] == ["  …", "", ""]
    markers = rows(msg.MarkerArray(markers=[msg.Marker() for _ in range(3)])._repr_html_())
    assert len(markers) == 61
    assert markers[-1] == ["…", "", ""]


def test_a_picture_is_a_short_table(msg: SimpleNamespace) -> None:
    assert len(msg.Image(data=bytes(10_000_000))._repr_html_()) < 2000


def test_values_that_are_wrong_are_shown_too(msg: SimpleNamespace) -> None:
    class Rude:
        def __repr__(self) -> str:
            raise ValueError("no")

    pose = msg.PoseStamped()
    pose.header.stamp, pose.header.frame_id, pose.pose = None, Rude(), 7
    cells = {name.strip(): value for name, value, _ in rows(pose._repr_html_())}
    assert cells["stamp"] == "None"
    assert "Rude" in cells["frame_id"]
    assert cells["pose"] == "7"
    path = msg.Path()
    path.poses = 5
    assert ["poses", "5", "sequence<geometry_msgs/PoseStamped>"] in rows(path._repr_html_())


def test_a_class_that_somebody_derived(msg: SimpleNamespace) -> None:
    class Mine(msg.Point):  # type: ignore[misc, name-defined]
        pass

    assert rows(Mine(x=0.1)._repr_html_()) == [
        ["x", "0.1", "double"],
        ["y", "0.0", "double"],
        ["z", "0.0", "double"],
    ]
