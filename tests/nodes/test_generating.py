"""`ifgen generate` with nodes, as users see it: their files stay, and messages say what they have to do."""

from __future__ import annotations

import json
from pathlib import Path

import ifgen
import pytest
from ifgen.cli import main

WS = Path("ws")
ARM = Path("generated/robot/robot/arm.py")


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = main.main(list(arguments))
    printed = capsys.readouterr()
    return code, printed.out, printed.err


def generate(*arguments: str) -> tuple[str, ...]:
    """Generate; return the rules of the diagnostics."""
    return tuple(found.rule for found in ifgen.generate(WS, output="generated").diagnostics)


def describe(name: str, text: str) -> None:
    path = WS / "robot/nodl" / f"{name}.nodl.yaml"
    path.write_text(f"nodl_version: 2\n{text}")


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


QOS = "{history: KEEP_LAST, depth: 5, reliability: RELIABLE}"
EARS = f"""
subscriptions:
  - {{name: /left/ear, type: std_msgs/String, qos: {QOS}}}
  - {{name: ~/right, type: std_msgs/String, qos: {QOS}}}
"""


@pytest.fixture
def ears(workspace: Path) -> Path:
    """A generated node with two subscriptions, and the user's module."""
    for other in ("arm", "brain", "gripper"):
        (WS / f"robot/nodl/{other}.nodl.yaml").unlink()
    describe("ears", EARS)
    assert generate() == ()
    return Path("generated/robot/robot/ears.py")


def test_layout(workspace: Path) -> None:
    done = ifgen.generate(WS, output="generated")
    written = {path.relative_to("generated/robot").as_posix() for path in done.written}
    assert {name for name in written if not name.startswith(("test/", "robot/msg"))} == {
        "package.xml",
        "setup.py",
        "setup.cfg",
        "resource/robot",
        *(f"resource/robot__{node}" for node in ("arm", "brain", "gripper")),
        "launch/robot.launch.py",
        "config/arm.yaml",
        "config/gripper.yaml",
        *(f"nodl/{node}.nodl.yaml" for node in ("arm", "brain", "gripper")),
        "robot/__init__.py",
        "robot/py.typed",
        "robot/_waiting.py",
        *(f"robot/_{node}_base.py" for node in ("arm", "brain", "gripper")),
        *(f"robot/_{node}_parameters.py" for node in ("arm", "gripper")),
        *(f"robot/{node}.py" for node in ("arm", "brain", "gripper", "checks")),
    }
    assert {"robot/msg/__init__.py", "robot/msg/_joint.py"} < written
    again = ifgen.generate(WS, output="generated")
    assert not again.written
    assert not again.diagnostics


def test_what_is_installed_is_read_back_as_it_was(workspace: Path) -> None:
    """The documents of the ament index have no includes and no `codegen`, and mean the same."""
    ifgen.generate(WS, output="generated")
    for path in Path("generated/robot/nodl").iterdir():
        text = path.read_text()
        assert (
            Path("generated/robot/resource") / f"robot__{path.name.partition('.')[0]}"
        ).read_text() == text
        again = "\n".join(line for line in text.splitlines() if "robot_checks" not in line)
        (WS / "robot/nodl" / path.name).write_text(again + "\n")
    assert ifgen.check(WS) == ()
    ifgen.generate(WS, output="again")
    for path in Path("generated/robot/nodl").iterdir():
        text = "\n".join(line for line in path.read_text().splitlines() if "robot_checks" not in line)
        assert (Path("again/robot/nodl") / path.name).read_text() == text + "\n"


def test_package_xml(workspace: Path) -> None:
    generate()
    text = Path("generated/robot/package.xml").read_text()
    assert "<version>0.0.0</version>" in text
    assert "TODO" not in text
    for depend in ("rclpy", "std_msgs", "std_srvs", "example_interfaces", "rcl_interfaces", "action_msgs"):
        assert f"<depend>{depend}</depend>" in text
    (WS / "robot/package.xml").write_text(
        '<package format="3"><name>robot</name><version>1.2.3</version><description>Arms &amp; "hands"</description>'
        '<maintainer email="a@b.org">A. B.</maintainer><license>MIT</license></package>'
    )
    generate()
    text = Path("generated/robot/package.xml").read_text()
    for line in (
        "<version>1.2.3</version>",
        "<license>MIT</license>",
        '<maintainer email="a@b.org">A. B.</maintainer>',
        "Arms &amp; ",
    ):
        assert line in text
    assert """description='Arms & "hands"',""" in Path("generated/robot/setup.py").read_text()


def test_dependencies_of_the_package_xml_stay(workspace: Path) -> None:
    """A node imports more than messages: what its package.xml declares is what colcon builds, and pip installs."""
    (WS / "robot/package.xml").write_text(
        """<package format="3"><name>robot</name><version>1.2.3</version>
        <buildtool_depend>ament_python</buildtool_depend> <build_depend>rosidl_default_generators</build_depend>
        <depend>rclpy</depend> <depend>std_msgs</depend>
        <depend>arm_kinematics</depend>
        <exec_depend condition="$ROS_VERSION &gt;= 2">python3-numpy</exec_depend>
        <test_depend>arm_scenes</test_depend></package>"""
    )
    pyproject = (
        '[tool.ifgen.requirements]\narm_kinematics = "arm-kinematics>=0.3"\narm_scenes = "arm-scenes"\n'
    )
    Path("pyproject.toml").write_text(f'[tool.ifgen]\npaths = ["{WS}"]\n{pyproject}')
    assert main.main(["generate"]) == 0
    lines = [line.strip() for line in Path("generated/robot/package.xml").read_text().splitlines()]
    assert lines.count("<depend>rclpy</depend>") == lines.count("<depend>std_msgs</depend>") == 1
    further = lines[lines.index("<depend>arm_kinematics</depend>") :]
    assert further[:3] == [
        "<depend>arm_kinematics</depend>",
        '<exec_depend condition="$ROS_VERSION &gt;= 2">python3-numpy</exec_depend>',
        "<test_depend>arm_scenes</test_depend>",
    ]
    assert not any("rosidl_default_generators" in line or "buildtool" in line for line in lines)
    setup = Path("generated/robot/setup.py").read_text()
    assert 'install_requires=["setuptools", "arm-kinematics>=0.3"],' in setup


def test_the_users_module_is_written_once(ears: Path) -> None:
    ears.write_text("# mine\n" + ears.read_text())
    mine = ears.read_text()
    describe("ears", EARS.replace("/left/ear", "/left/ear2"))
    generate()
    assert ears.read_text() == mine
    ears.unlink()
    generate()
    assert "on_left_ear2" in ears.read_text()


def test_check_wants_the_users_module_and_does_not_compare_it(
    ears: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ears.write_text("# mine\n" + ears.read_text())
    assert run(capsys, "generate", "ws", "--check")[0] == 0
    ears.unlink()
    code, out, _ = run(capsys, "generate", "ws", "--check")
    assert (code, out) == (1, f"+++ {ears} (missing)\n")


def test_methods_that_are_missing_and_orphaned_are_named_with_their_lines(
    ears: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    describe("ears", EARS.replace("/left/ear", "/left/hearing"))
    for arguments in (("generate", "ws"), ("generate", "ws"), ("generate", "ws", "--check"), ("check", "ws")):
        code, out, err = run(capsys, *arguments)
        assert code == 1
        said = out + err
        assert "error[missing-method]: Ears has no method on_left_hearing" in said
        assert "warning[orphaned-method]: nothing calls on_left_ear" in said
        assert f"{ears}:18:7" in said, "the class"
        assert f"{ears}:25:9" in said, "the method"
        assert "def on_left_hearing(self, message: String) -> None" in said
    document = json.loads(run(capsys, "check", "ws", "--format", "json")[1])
    places = {d["rule"]: d["labels"][0]["start"]["line"] for d in document["diagnostics"]}
    assert places == {"missing-method": 18, "orphaned-method": 25}


def test_an_edit_of_the_users_module_is_noticed(ears: Path) -> None:
    edit(ears, "def on_right", "def on_write")
    assert generate() == ("missing-method", "orphaned-method")
    edit(ears, "def on_write", "def on_right")
    assert generate() == ()


@pytest.mark.parametrize(
    ("text", "rules"),
    [
        ("class Ears(EarsBase):\n def on_left_ear(self, m): pass\n on_right = on_left_ear", ()),
        (
            "class A(EarsBase):\n def on_left_ear(self, m): pass\nclass Ears(A):\n async def on_right(self, m): pass",
            (),
        ),
        (
            "class A:\n def on_left_ear(self, m): pass\nclass Ears(A, base.EarsBase):\n pass",
            ("missing-method",),
        ),
        ("from mine import Mixin\nclass Ears(Mixin, EarsBase):\n pass", ()),  # it may contain anything
        ("from mine import Ears", ()),
        ("from mine import *", ()),
        ("@complete\nclass Ears(EarsBase):\n pass", ()),  # it may add anything
        (
            "class Ears(EarsBase):\n on_right: object = print\n if True:\n  def on_left_ear(self, m): pass",
            (),
        ),
        (
            "class Ears(EarsBase):\n on_right = print\n on_left_ear: object\n def f(self):\n  on_left_ear = 1",
            ("missing-method",),
        ),
        ("Ears = make()", ()),
        ("class Eyes(EarsBase):\n pass", ("user-module",)),
        ("class Ears(EarsBase:", ("user-module",)),
        ("\0", ("user-module",)),
        ("", ("user-module",)),
        (
            "class Ears(EarsBase):\n on_left_ear = on_right = print\n def on_click(self): pass",
            ("orphaned-method",),
        ),
        (
            "class Ears(EarsBase):\n on_left_ear = on_right = print\n def on_click(self): pass\n"
            " def f(self): use(self.on_click)",
            (),
        ),
        (
            "class Ears(EarsBase):\n on_left_ear = on_right = print\n"
            " def f(self): self.publish_ä(1), self.send_mail(), self.call_a\n def send_mail(self): self.call_a = 1",
            ("vanished-method",),
        ),
    ],
)
def test_how_a_module_is_read(text: str, rules: tuple[str, ...], ears: Path) -> None:
    ears.write_text(text + "\n")
    assert generate() == rules


PARAMETERS = """
parameters:
  nickname: {type: string, default_value: pit}
  step.length: {type: double, default_value: 0.1}
  marker: {type: none}
"""


@pytest.mark.parametrize(
    ("body", "gone"),
    [
        ("return self.parameters.nickname.upper(), self.parameters.step.length", ()),
        ("return self.parameters.robot_name", ("robot_name",)),
        ("return self.parameters.robot_name.upper(), self.parameters.gone.x", ("robot_name", "gone")),
        ("return self.parameters.step.lenght", ("step.lenght",)),
        ("return self.parameters.marker", ("marker",)),  # which has no value
        ("p = self.parameters; s = p.step; return s.width, p.length", ("step.width", "length")),
        ("p = self.parameters; p = other(); return p.length", ()),
        ("for p in self.parameters: p = self.parameters.step; p.length2", ()),
        ("return self.parameters.__class__, other.parameters.x", ()),
        ("self.parameters = mine(); return self.parameters.x", ()),
    ],
)
def test_parameters_that_are_gone_are_told(body: str, gone: tuple[str, ...], ears: Path) -> None:
    describe("ears", EARS + PARAMETERS)
    edit(ears, "    def on_right", f"    def mine(self):\n        {body}\n\n    def on_right")
    found = ifgen.generate(WS, output="generated").diagnostics
    assert [f.message for f in found] == [
        f"there is no parameter {name}: ears has none of that name" for name in gone
    ]
    assert {(f.rule, f.severity) for f in found} <= {("vanished-parameter", "warning")}


def test_a_parameter_that_is_gone_is_shown_where_it_is_read(
    ears: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    describe("ears", EARS + PARAMETERS)
    mine = "    def on_parameters_changed(self, now):\n        print('ä', now.nickame)\n\n"
    edit(ears, "    def on_right", f"{mine}    def on_right")
    code, _, err = run(capsys, "generate", "ws")
    assert code == 0
    [line] = [line for line in err.splitlines() if "now.nickame" in line]
    [marks] = [line for line in err.splitlines() if "^" in line]
    assert (marks.index("^"), marks.count("^")) == (line.index("now.nickame"), len("now.nickame"))
    assert "did you mean `nickname`?" in err
    describe("ears", EARS)
    assert "it has no parameters" in run(capsys, "generate", "ws")[2]


@pytest.mark.parametrize(
    ("text", "place", "why"),
    [
        ("class Ears(EarsBase):\n    x = (1,\n", "2:9", "was never closed"),
        ("a = 1\nb = \0\n", "", "null byte"),
        ("'ä'; a b\n", "1:8", "invalid syntax"),
        ("x = " + "-" * 100_000 + "1\n", "1:1", "nested too deeply"),
    ],
)
def test_what_is_not_python_is_told_with_its_place(
    text: str, place: str, why: str, ears: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ears.write_text(text)
    code, _, err = run(capsys, "generate", "ws")
    assert code == 1
    assert "error[user-module]: ears.py is not Python, so its node cannot start" in err
    assert f"{ears}:{place}" in err
    assert why in err


def test_an_edited_base_is_kept_beside_and_told_once(ears: Path, capsys: pytest.CaptureFixture[str]) -> None:
    base = ears.with_name("_ears_base.py")
    before = base.read_text()
    base.write_text(f"{before}# mine\n")
    code, _, err = run(capsys, "generate", "ws")
    assert (code, base.read_text()) == (0, before)
    assert "warning[edited-file]: generated/robot/robot/_ears_base.py was edited" in err
    kept = Path("generated/.ifgen-edited/robot/robot/_ears_base.py")
    assert str(kept) in " ".join(err.split())
    assert kept.read_text() == f"{before}# mine\n"
    assert run(capsys, "generate", "ws") == (0, "generated: up to date (15 files)\n", "")
    assert run(capsys, "generate", "ws", "--check")[0] == 0
    for name in ("_ears_base.py", "__init__.py", "py.typed"):
        ears.with_name(name).write_text("mine")
    err = run(capsys, "generate", "ws")[2]
    assert "generated/robot/robot/__init__.py and 2 more generated files were edited" in err
    assert err.count("warning") == 1


def test_the_policy_towards_other_definitions(ears: Path) -> None:
    base = ears.with_name("_ears_base.py")
    assert "on_type_mismatch" not in base.read_text()
    describe(
        "ears", EARS.replace("~/right", "type_mismatch") + "codegen: {ifgen: {on_type_mismatch: adapt}}\n"
    )
    generate()
    text = base.read_text()
    assert '    on_type_mismatch = "adapt"\n' in text
    assert text.count("on_type_mismatch =") == 1
    assert "def on_type_mismatch(" not in text  # the subscription's callback, which would hide it


def test_a_node_that_is_gone_leaves_the_users_module(ears: Path, capsys: pytest.CaptureFixture[str]) -> None:
    describe("eyes", EARS)
    generate()
    (WS / "robot/nodl/ears.nodl.yaml").unlink()
    code, out, err = run(capsys, "generate", "ws")
    assert code == 0
    assert f"removed {ears.with_name('_ears_base.py')}" in out
    assert f"{ears} is yours, but no node uses it any more: it stays" in err
    assert ears.exists()
    (WS / "robot/nodl/eyes.nodl.yaml").unlink()
    generate()
    assert ears.with_name("eyes.py").exists()
    assert not Path("generated/robot/package.xml").exists()
    assert Path("generated/robot/msg/_joint.py").exists(), "laid out as a package of interfaces again"


def test_what_is_wrong_leaves_everything_as_it_was(ears: Path) -> None:
    before = {path: path.read_bytes() for path in Path("generated").rglob("*") if path.is_file()}
    describe("eyes", EARS.replace("std_msgs/String", "std_msgs/Strin"))
    with pytest.raises(ifgen.InputError, match="Strin"):
        generate()
    assert {path: path.read_bytes() for path in Path("generated").rglob("*") if path.is_file()} == before


def test_a_single_description_adds_to_its_package(ears: Path) -> None:
    describe("eyes", EARS)
    ifgen.generate(WS / "robot/nodl/eyes.nodl.yaml", output="generated")
    assert ears.with_name("_ears_base.py").exists()
    assert ears.with_name("_eyes_base.py").exists()
    assert ears.with_name("msg").is_dir()


def test_functions_of_custom_validators_are_the_users(workspace: Path) -> None:
    generate()
    checks = Path("generated/robot/robot/checks.py")
    text = checks.read_text()
    assert "def odd_count(value: tuple[str, ...]) -> None:" in text
    assert "def even(value: int, argument1: int) -> None:" in text
    checks.write_text("from other import odd_count\n")
    assert generate() == ("missing-check",)
    for text in (
        "odd_count = even = print",
        "from other import *",
        "try:\n def even(v): 0\nfinally:\n odd_count = 1",
    ):
        checks.write_text(text + "\n")
        assert generate() == ()
    edit(WS / "robot/nodl/arm.nodl.yaml", "robot.checks.even", "robot.brain.even")
    with pytest.raises(ifgen.InputError, match="which is a module of a node"):
        generate()
    edit(WS / "robot/nodl/arm.nodl.yaml", "robot.brain.even", "elsewhere.checks.even")
    assert generate() == ()
    assert (
        "from elsewhere import checks as elsewhere_checks"
        in Path("generated/robot/robot/_arm_parameters.py").read_text()
    )


def test_dependencies_come_with_deps_only(ears: Path) -> None:
    assert not Path("generated/std_msgs").exists()
    ifgen.generate(WS, output="generated", with_deps=True)
    assert Path("generated/std_msgs/msg/_string.py").exists()
    assert ifgen.generate(WS, output="generated", with_deps=True).written == ()


def test_changes_that_a_package_of_nodes_depends_on_are_noticed(workspace: Path) -> None:
    generate()
    for path, old, new in (
        (WS / "robot/nodl/arm.nodl.yaml", "default_value: 2.5", "default_value: 2.6"),
        (WS / "robot/msg/Joint.msg", "float64 angle", "float32 angle"),
    ):
        edit(path, old, new)
        assert ifgen.generate(WS, output="generated").written
        assert not ifgen.generate(WS, output="generated").written


def test_names_that_meet_get_their_category(workspace: Path) -> None:
    describe(
        "odd",
        f"""
subscriptions:
  - {{name: /a/b, type: std_msgs/String, qos: {QOS}}}
  - {{name: ~/a_b, type: std_msgs/String, qos: {QOS}}}
  - {{name: parameters_changed, type: std_msgs/String, qos: {QOS}}}
publishers:
  - {{name: create, type: std_msgs/String, qos: {QOS}}}
service_servers:
  - {{name: destroy, type: std_srvs/Trigger}}
""",
    )
    generate()
    text = Path("generated/robot/robot/odd.py").read_text()
    methods = (
        "on_a_b",
        "on_a_b_subscription",
        "on_parameters_changed_subscription",
        "handle_destroy_service",
    )
    for method in methods:
        assert f"def {method}(" in text
    assert "publish_create_publisher(String())" in text


def test_classes_of_one_name_are_told_apart(workspace: Path) -> None:
    describe(
        "mixed",
        f"""
subscriptions:
  - {{name: a, type: robot/Joint, qos: {QOS}}}
  - {{name: b, type: other_robot/Joint, qos: {QOS}}}
  - {{name: c, type: other_robot/Node, qos: {QOS}}}
""",
    )
    (WS / "other_robot/msg").mkdir(parents=True)
    for name in ("Joint", "Node"):
        (WS / f"other_robot/msg/{name}.msg").write_text("int32 n\n")
    generate()
    text = Path("generated/robot/robot/mixed.py").read_text()
    for reference in ("robot_msg_Joint", "other_robot_msg_Joint", "other_robot_msg_Node"):
        assert f"message: {reference}) -> None" in text
