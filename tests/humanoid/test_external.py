"""Somebody else's robot: it walks under its own names, and errors name what is wrong with it."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import yaml
from humanoid.control.reference import straight_steps
from humanoid.data import FootstepPlan
from humanoid.robot import table
from humanoid.robot.external import load_external
from humanoid.robot.mjcf import write_mjcf
from humanoid.robot.table import ModelError
from humanoid.simulation.sim import Noise
from humanoid.trials.harness import Lockstep
from hypothesis import given, settings
from hypothesis import strategies as st

THEIRS = {
    name: re.sub("^l_", "left_", re.sub("^r_", "right_", name)) + "_joint" for name in table.JOINT_NAMES
}


def _bare(**changes: str) -> str:
    """Our robot as somebody else might describe it: other names, no servos, no sensors, no sites, heavier."""
    root = ElementTree.fromstring(write_mjcf())
    for tag in ("actuator", "sensor"):
        root.remove(root.find(tag) or ElementTree.Element(""))
    for parent in list(root.iter("body")):
        for child in [child for child in parent if child.tag in ("site", "camera")]:
            parent.remove(child)
    for joint in root.iter("joint"):
        if joint.get("name"):
            joint.set("name", THEIRS[joint.attrib["name"]])
    for body in root.iter("body"):
        body.set(
            "name", {"base_link": "pelvis", "torso": "trunk"}.get(body.attrib["name"], body.attrib["name"])
        )
        if body.get("name") == "trunk":
            body.findall("geom")[0].set("mass", "10")
    text = ElementTree.tostring(root, encoding="unicode")
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    return text


def _map(**changes: object) -> dict[str, object]:
    return {
        "base": "pelvis",
        "torso": "trunk",
        "sole": {"centre": 0.02, "length": 0.22, "width": 0.11},
        "joints": dict(THEIRS),
        "frames": {"gaze": {"body": "head", "xyz": [0.085, 0, 0.08]}},
        **changes,
    }


def _written(folder: Path, model: str, joint_map: object) -> tuple[Path, Path]:
    (folder / "robot.xml").write_text(model)
    text = joint_map if isinstance(joint_map, str) else yaml.safe_dump(joint_map)
    (folder / "map.yaml").write_text(text)
    return folder / "robot.xml", folder / "map.yaml"


def _error(folder: Path, model: str, joint_map: object) -> str:
    with pytest.raises(ModelError) as caught:
        load_external(*_written(folder, model, joint_map))
    text = str(caught.value)
    assert "\n" not in text
    return text.replace(str(folder) + "/", "")


@pytest.mark.slow
def test_walks_under_other_names(tmp_path: Path) -> None:
    model = load_external(*_written(tmp_path, _bare(), _map()))
    assert abs(model.mass - 37.05) < 1e-6
    robot_ = Lockstep(model, seed=1, noise=Noise())
    robot_.run(0.5)
    assert robot_.controller.follow(FootstepPlan(1, straight_steps(5, 0.15, 0.18), (0.6, 0.0, 0.0))) == ""
    robot_.settle(12.0)
    assert not robot_.fell
    assert len(robot_.touchdowns) == 5
    assert robot_.foot_error()[0] < 0.03


def test_our_own_file_needs_no_map(tmp_path: Path) -> None:
    path = tmp_path / "robot.xml"
    path.write_text(write_mjcf())
    model = load_external(path)
    assert abs(model.mass - 35.05) < 1e-9
    data = model.data()
    assert np.allclose(model.leg.hip, table.HIP_OFFSET)
    assert data.cam("head_camera") is not None


WRONG_MAPS = [
    (_map(joints={**THEIRS, "l_knee": "left_nee_joint"}), "robot.xml: no joint 'left_nee_joint' for 'l_knee'; did you mean 'left_knee_joint'?"),
    (_map(joints={**THEIRS, "l_kne": "x"}), "map.yaml: joints: unknown entry 'l_kne'; did you mean 'l_knee'?"),
    (_map(joints={**THEIRS, "l_knee": "right_knee_joint"}), "map.yaml: joints.r_knee: 'right_knee_joint' is already used for 'l_knee'"),
    (_map(joints={**THEIRS, "l_knee": 3}), "map.yaml: joints.l_knee: expected a name, got '3'"),
    (_map(joints=["l_knee"]), "map.yaml: joints: expected a mapping, got a list"),
    (_map(base="pelvsi"), "robot.xml: no body 'pelvsi' for 'base'; did you mean 'pelvis'?"),
    (_map(base="trunk"), "robot.xml: body 'trunk' has no free joint, so the robot cannot move"),
    (_map(bsae="pelvis"), "map.yaml: the file: unknown entry 'bsae'; did you mean 'base'?"),
    (_map(sole={"centre": 0.0, "length": 0.2}), "map.yaml: sole: 'width' is missing"),
    (_map(sole={"centre": 0.0, "length": 0.0, "width": 0.1}), "map.yaml: sole: length and width must be above 0.04 m"),
    (_map(sole={"centre": ".nan", "length": 0.2, "width": 0.1}), "map.yaml: sole.centre: expected a number, got '.nan'"),
    (_map(frames={"l_sole": "sohle"}), "robot.xml: no site 'sohle' for 'l_sole'"),
    (_map(frames={"l_sole": {"xyz": [0, 0, 0]}}), "map.yaml: frames.l_sole: expected the name of a site, or a mapping with 'body'"),
    (_map(frames={"l_sole": {"body": "l_ankle", "xyz": [0, 0]}}), "map.yaml: frames.l_sole.xyz: expected three numbers, got a list"),
    (_map(frames={"tail": "x"}), "map.yaml: frames: unknown entry 'tail'"),
    ("joints: [", "map.yaml:1:10: expected the node content, but found '<stream end>'"),
    ("just words", "map.yaml: the file: expected a mapping, got 'just words'"),
    ("", "map.yaml: the file: expected a mapping, got nothing"),
]  # fmt: skip


@pytest.mark.parametrize(("joint_map", "text"), WRONG_MAPS)
def test_a_wrong_map_names_the_entry(tmp_path: Path, joint_map: object, text: str) -> None:
    assert _error(tmp_path, _bare(), joint_map) == text


WAIST = 'name="waist_yaw_joint" axis="0.0 0.0 1.0"'
KNEE = 'name="left_knee_joint" axis="0.0 1.0 0.0"'
WRONG_MODELS = [
    ({WAIST: 'name="waist_yaw_joint" axis="0.0 0.0 -1.0"'}, "joint 'waist_yaw_joint' turns about (0, 0, -1) with all joints at zero; 'waist_yaw' turns about (0, 0, 1)"),
    ({KNEE: KNEE + ' type="slide"'}, "joint 'left_knee_joint' is not a hinge"),
    ({KNEE: KNEE + ' type="hing"'}, "XML Error: invalid keyword: 'hing'; Element 'joint', line "),
    ({'<body name="l_thigh"': '<bdy name="l_thigh"'}, "XML parse error 14"),
    ({'<freejoint name="floating_base" />': ""}, "body 'pelvis' has no free joint"),
    ({'name="left_knee_joint"': 'name="left_hip_yaw_joint"'}, "repeated name 'left_hip_yaw_joint'"),
    ({'name="pelvis"': 'name="pelvis" x="1"'}, "unrecognized attribute: 'x'"),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "text"), WRONG_MODELS)
def test_a_wrong_model_names_the_element(tmp_path: Path, changes: dict[str, str], text: str) -> None:
    found = _error(tmp_path, _bare(**changes), _map())
    assert found.startswith("robot.xml: ")
    assert text in found


def test_files_that_are_none(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match=r"no\.xml: there is no such file"):
        load_external(tmp_path / "no.xml")
    model, _ = _written(tmp_path, write_mjcf(), "")
    with pytest.raises(ModelError, match=r"no\.yaml: No such file"):
        load_external(model, tmp_path / "no.yaml")
    (tmp_path / "bytes.yaml").write_bytes(b"\xff\xfe\x00joints")
    with pytest.raises(ModelError, match=r"bytes\.yaml: this is not UTF-8 text"):
        load_external(model, tmp_path / "bytes.yaml")
    with pytest.raises(ModelError, match=f"{tmp_path}: this is a folder"):
        load_external(tmp_path)
    with pytest.raises(ModelError, match=f"{tmp_path}: Is a directory"):
        load_external(model, tmp_path)


OURS = write_mjcf()
L_KNEE = re.search(r'<joint name="l_knee"[^>]*>', OURS)
assert L_KNEE is not None
BOX = '<body name="box"><freejoint name="box_moves" /><geom size="0.1" /></body>'
WORLD = "<worldbody>"
STRANGE_FILES: list[tuple[str | bytes, str]] = [
    ("", "empty file"),
    (" \n", "empty document: is this an XML file?"),
    ("robot: 1", "in line 1: parsing text: is this an XML file?"),
    (bytes(range(256)), "is this an XML file?"),
    (b"\x1f\x8b\x08\0" + bytes(100), "is this an XML file?"),
    (OURS[:900] + "\0" + OURS[900:], "is this an XML file?"),
    ("<html><body/></html>", "Unrecognized XML model type: 'html'"),
    ("<mujoco/>", "no body 'base_link' for 'base'"),
    (OURS.replace(WORLD, f"<include file='nowhere.xml' />{WORLD}", 1), "Error opening file 'nowhere.xml'"),
    (OURS.replace(WORLD, f"<include file='robot.xml' />{WORLD}", 1), "'robot.xml' already included"),
    (OURS.replace(L_KNEE[0], ""), "no joint 'l_knee' for 'l_knee'; did you mean 'r_knee'?"),
    (OURS.replace('name="l_knee"', 'name="l_knee" type="ball"', 1), "joint 'l_knee' is not a hinge"),
    (re.sub(r'(name="l_knee"[^>]*range=")[^"]*', r"\1nan nan", OURS), "joint 'l_knee' has "),
    (
        re.sub(r'(name="l_knee"[^>]*range=")[^"]*', r"\g<1>1 -1", OURS),
        "joint 'l_knee' has no range, or an empty one",
    ),
    (
        OURS.replace("<freejoint", '<freejoint name="second" /><freejoint', 1),
        "more than 6 dofs in body 'base_link'",
    ),
    (OURS.replace(WORLD, WORLD + BOX, 1), "body 'base_link' is not the first that moves"),
    (re.sub('mass="[^"]*"', 'mass="-1"', OURS, count=1), "mass, inertia or density are negative"),
    (OURS.replace(WORLD, f"<option timestep='1' />{WORLD}", 1), "option timestep is 1 s"),
    (OURS.replace(WORLD, f"<option gravity='0 0 1' />{WORLD}", 1), "option gravity is '0 0 1'"),
]


@pytest.mark.parametrize(("content", "words"), STRANGE_FILES, ids=[words for _, words in STRANGE_FILES])
def test_strange_files_are_one_sentence_that_names_the_element(
    tmp_path: Path, content: str | bytes, words: str
) -> None:
    path = tmp_path / "robot.xml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(ModelError) as caught:
        load_external(path)
    text = str(caught.value)
    assert text.startswith(f"{path}: ")
    assert words in text
    assert "\n" not in text


def test_what_is_missing_is_added(tmp_path: Path) -> None:
    bare = re.sub("<actuator>.*</actuator>", "", OURS, flags=re.DOTALL)
    for name, text in (
        ("bare.xml", bare),
        ("beside.xml", OURS.replace("</worldbody>", f"{BOX}</worldbody>")),
    ):
        assert text != OURS
        (tmp_path / name).write_text(text)
        assert load_external(tmp_path / name).kp.shape == (29,)
    (tmp_path / "robot").write_text(OURS)
    with pytest.raises(ModelError, match=r"the name of a model must end in \.xml"):
        load_external(tmp_path / "robot")


_KEYS = st.sampled_from(
    ["base", "torso", "sole", "joints", "frames", "l_knee", "l_sole", "body", "xyz", "centre"]
)
_LEAVES = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=5)
    | st.sampled_from(["pelvis", "gaze"])
)
_MAPS = st.recursive(
    _LEAVES,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(_KEYS, inner, max_size=4),
    max_leaves=12,
)


@settings(max_examples=150)
@given(document=st.dictionaries(_KEYS, _MAPS, max_size=5) | _MAPS)
def test_any_map_is_one_clear_error(tmp_path: Path, document: object) -> None:
    assert _error(tmp_path, "<mujoco/>", document)


@settings(max_examples=60)
@given(place=st.integers(0, 15000), length=st.integers(1, 200), new=st.text('<>"=/ abc019.', max_size=6))
def test_any_damage_to_a_model_is_one_clear_error(tmp_path: Path, place: int, length: int, new: str) -> None:
    text = write_mjcf()
    path = tmp_path / "robot.xml"
    path.write_text(text[:place] + new + text[place + length :])
    try:
        load_external(path)
    except ModelError as error:
        assert "\n" not in str(error)
