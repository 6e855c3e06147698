"""What actions do: arguments, scopes, defaults of nodes, events; by launches that start nothing."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest
import yaml
from ifgen_runtime.parameters import parameter_yaml
from launch._errors import LaunchError
from launch.launch_context import Files

from .conftest import Recorded

HEAD = """
import os
from launch import LaunchDescription
from launch.actions import *
from launch.conditions import *
from launch.event_handlers import *
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import *
from launch_ros.actions import *
from launch_ros.parameter_descriptions import *
from launch_ros.substitutions import *
from launch_xml.launch_description_sources import XMLLaunchDescriptionSource

def say(*parts):
    return LogInfo(msg=list(parts))

def generate_launch_description():
    return LaunchDescription([
"""


def described(*lines: str) -> str:
    return HEAD + "".join(f"        {line},\n" for line in lines) + "    ])\n"


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        (["DeclareLaunchArgument('a', default_value='1')", "say(LaunchConfiguration('a'))"], ["1"]),
        (["say('x', condition=None) if 0 else say(PythonExpression(['2', ' * 0.1']))"], ["0.2"]),
        (
            [
                "LogInfo(msg='a', condition=IfCondition('0'))",
                "LogInfo(msg='b', condition=UnlessCondition('False'))",
            ],
            ["b"],
        ),
        (
            [
                "GroupAction([SetLaunchConfiguration('a', '1')])",
                "say(LaunchConfiguration('a', default='none'))",
            ],
            ["none"],
        ),
        (
            [
                "GroupAction([SetLaunchConfiguration('a', '1')], scoped=False)",
                "say(LaunchConfiguration('a'))",
            ],
            ["1"],
        ),
        (
            [
                "SetLaunchConfiguration('a', '1')",
                "GroupAction([say(LaunchConfiguration('a', default='-'), LaunchConfiguration('b'))], forwarding=False,"
                " launch_configurations={'b': LaunchConfiguration('a')})",
            ],
            ["-1"],
        ),
        (
            [
                "SetEnvironmentVariable('IFGEN_T', 'a')",
                "AppendEnvironmentVariable('IFGEN_T', 'b')",
                "say(EnvironmentVariable('IFGEN_T'))",
            ],
            ["a:b"],
        ),
        (
            [
                "GroupAction([SetEnvironmentVariable('IFGEN_T', 'a')])",
                "say(EnvironmentVariable('IFGEN_T', default_value='none'))",
            ],
            ["none"],
        ),
        (
            ["OpaqueFunction(function=lambda context, x: [say(x, context.argv and 'y' or 'z')], args=['x'])"],
            ["xz"],
        ),
        (
            ["say(EqualsSubstitution('1.0', 1), NotSubstitution('true'), IfElseSubstitution('1', 'a', 'b'))"],
            ["truefalsea"],
        ),
        (
            ["say(AnySubstitution('0', 'true'), AllSubstitution('0', '1'), OrSubstitution('0', '1'))"],
            ["truefalsetrue"],
        ),
        (["say(Command('echo a b'))"], ["a b\n"]),
        (["say(StringJoinSubstitution(['a', TextSubstitution(text='b')], delimiter='-'))"], ["a-b"]),
        (["TimerAction(period=0.01, actions=[say('late')])", "say('early')"], ["early", "late"]),
        (
            ["RegisterEventHandler(OnShutdown(on_shutdown=[say('bye')]))", "Shutdown(reason='enough')"],
            ["bye"],
        ),
        (
            ["RegisterEventHandler(OnShutdown(on_shutdown=lambda event, context: say(event.reason)))"],
            ["idle"],
        ),
        (
            [
                "(lambda a: GroupAction([RegisterEventHandler(OnExecutionComplete(target_action=a, on_completion=[say('done')])), a]))(say('a'))"
            ],
            ["a", "done"],
        ),
    ],
)
def test_what_is_said(lines: list[str], said: list[str], record: Recorded) -> None:
    recorder = record("a.launch.py", described(*lines))
    assert (recorder.exit_code, recorder.said) == (0, said)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (
            "DeclareLaunchArgument('a', description='The rate')",
            "the argument 'a' (The rate) has no value: add a:=VALUE",
        ),
        (
            "DeclareLaunchArgument('a', default_value=['b'], choices=['c', 'd'])",
            "the argument 'a' has the value 'b': choose from 'c', 'd'",
        ),
        ("LogInfo(msg=LaunchConfiguration('a'))", "launch configuration 'a' does not exist"),
        ("LogInfo(msg=EnvironmentVariable('IFGEN_NO'))", "environment variable 'IFGEN_NO' does not exist"),
        ("LogInfo(msg=PythonExpression('1 +'))", "the Python expression '1 +' fails: SyntaxError"),
        ("LogInfo(msg=Command('false'))", "the command 'false' ended with 1: no output"),
        ("LogInfo(msg=FindExecutable(name='ifgen-no'))", "executable 'ifgen-no' not found on the PATH"),
        (
            "LogInfo(msg='a', condition=IfCondition('maybe'))",
            "expected 'true', 'false', '1' or '0', got 'maybe'",
        ),
        ("Node(package='batery_monitor', executable='a')", "there is no package 'batery_monitor'"),
        ("Node(package='battery_monitor', executable='a')", "the package 'battery_monitor' in "),
        ("Node(executable='a', name='a-b')", "'a-b' is no name of a node"),
        ("Node(executable='a', namespace='a b')", "'a b' is no namespace"),
        (
            "Node(executable='a', parameters=[{'p': ParameterValue('x', value_type=int)}])",
            "the parameter 'p': expected a value of type int, got 'x'",
        ),
        ("ExecuteProcess(cmd=[])", "the command of a process is empty"),
        (
            "ExecuteProcess(cmd=['a'], output='nowhere')",
            "output must be one of screen, log, both, own_log, full, got 'nowhere'",
        ),
        (
            "ExecuteProcess(cmd=['a'], sigterm_timeout='soon')",
            "sigterm_timeout must be a number of seconds, got 'soon'",
        ),
        (
            "TimerAction(period='soon', actions=[])",
            "the period of a timer must be a number of seconds, got 'soon'",
        ),
        (
            "IncludeLaunchDescription('none.launch.py')",
            "cannot read the launch file 'none.launch.py': there is no such file",
        ),
        ("OpaqueFunction(function=lambda context: 5)", "expected an action, or a list of actions, got 5"),
    ],
)
def test_mistakes_while_it_runs(
    line: str, message: str, record: Recorded, capsys: pytest.CaptureFixture[str]
) -> None:
    recorder = record("a.launch.py", described(line))
    assert recorder.exit_code == 1
    errors = [each for each in capsys.readouterr().out.splitlines() if each.startswith("[ERROR]")]
    place = f"a.launch.py:{HEAD.count(chr(10)) + 1}: {message}"
    assert place in errors[0]


def test_files_include_each_other_with_arguments(record: Recorded, tmp_path: Path) -> None:
    (tmp_path / "b.launch.xml").write_text(
        "<launch><arg name='n'/><log message='$(var n) $(filename)'/>"
        "<include file='$(dirname)/c.launch.yaml'/><log message='$(filename)'/></launch>"
    )
    (tmp_path / "c.launch.yaml").write_text("launch:\n- log: {message: $(dirname) $(var n)}\n")
    include = "IncludeLaunchDescription(XMLLaunchDescriptionSource([ThisLaunchFileDir(), '/b.launch.xml']), launch_arguments={'n': '5'}.items())"
    recorder = record("a.launch.py", described(include, "say(ThisLaunchFile())"))
    b, a = tmp_path / "b.launch.xml", tmp_path / "a.launch.py"
    assert recorder.said == [f"5 {b}", f"{tmp_path} 5", str(b), str(a)]


def test_a_file_that_includes_itself_is_a_mistake(
    record: Recorded, capsys: pytest.CaptureFixture[str]
) -> None:
    assert record("a.launch.xml", "<launch>\n<include file='$(filename)'/></launch>").exit_code == 1
    assert "launch files include each other without an end" in capsys.readouterr().out


def test_nodes_get_namespaces_remappings_and_parameters_from_outside_to_inside(
    record: Recorded, tmp_path: Path
) -> None:
    program = tmp_path / "talker.py"
    program.touch()
    file = tmp_path / "given.yaml"
    file.write_text("/**:\n  ros__parameters:\n    who: $(var who)\n")
    recorder = record(
        "a.launch.py",
        described(
            "DeclareLaunchArgument('who', default_value='me')",
            "GroupAction([PushRosNamespace('a'), PushRosNamespace('b'), SetRemap('x', 'y'), "
            "SetParametersFromFile(os.path.join(os.path.dirname(__file__), 'given.yaml')), "
            "Node(executable='talker.py', namespace='c', remappings=[('p', 'q')], ros_arguments=['--log-level', 'debug'])])",
            "Node(executable='talker.py', namespace='/d', name='n')",
            "Node(executable='talker.py')",
        ),
    )
    first, second, third = (list(process.command) for process in recorder.started)
    begin = first.index("--ros-args")
    assert first[begin:] == [
        *("--ros-args", "--log-level", "debug", "-r", "__ns:=/a/b/c", "--params-file", str(file)),
        *("-r", "x:=y", "-r", "p:=q"),
    ]
    assert second[second.index("--ros-args") :] == ["--ros-args", "-r", "__node:=n", "-r", "__ns:=/d"]
    assert third[-3:] == ["--transport", "local", str(program)]


def test_values_of_parameters_keep_their_types(record: Recorded, tmp_path: Path) -> None:
    """Texts such as `y` and `off` are truths for rcl, unless they are in quotes."""
    written: list[str] = []

    def keep(self: Files, text: str) -> str:
        written.append(text)
        return "file"

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Files, "text", keep)
        record(
            "a.launch.py",
            described(
                "Node(executable='true', parameters=[{'a': 'y', 'b': 0.1, 'c': [1, 2.5], 'd': True, "
                "'e': PythonExpression('1 + 1'), 'f': ParameterValue(PythonExpression('1'), value_type=str), "
                "'g': {'h': ['x', 'off']}, 'i': [TextSubstitution(text='p'), 'q']}])"
            ),
        )
    assert "a: 'y'" in written[0]
    values = yaml.safe_load(written[0])["/**"]["ros__parameters"]
    assert values == {
        **{"a": "y", "b": 0.1, "c": [1.0, 2.5], "d": True, "e": 2, "f": "1"},
        **{"g": {"h": ["x", "off"]}, "i": "pq"},
    }


TEXTS = (
    "1e5",
    "y",
    "off",
    "2026-01-31",
    "12:30:45",
    "0x1F",
    "007",
    "nan",
    "null",
    "~",
    "1_000",
    "a",
    "5",
    ".inf",
)


@pytest.mark.parametrize("text", TEXTS)
def test_a_text_is_read_as_nodes_read_it(
    record: Recorded, monkeypatch: pytest.MonkeyPatch, text: str
) -> None:
    """In each kind of launch file; in Python, a text is one unless a substitution makes it."""
    given: list[Any] = []

    def keep(context: object, parameters: dict[str, Any], node: str) -> str:
        given.append(parameters["p"])
        return "file"

    monkeypatch.setattr("launch_ros.actions.node.written", keep)
    made = f"LaunchConfiguration('x', default='{text}')"
    record("a.launch.py", described(f"Node(executable='true', parameters=[{{'p': {made}}}])"))
    record("a.launch.xml", f"<launch><node exec='true'><param name='p' value='{text}'/></node></launch>")
    record("a.launch.yaml", f"launch: [node: {{exec: 'true', param: [{{name: p, value: {text}}}]}}]")
    expected = repr(parameter_yaml.value_of(text))
    assert list(map(repr, given)) == [expected] * 3


def test_a_list_that_is_used_twice(record: Recorded, capsys: pytest.CaptureFixture[str]) -> None:
    """What no file can hold is left out, and said."""
    files = "[{'a': g, 'b': g, 'c': []} for g in [[0.1, 2.5]]]"
    recorder = record("a.launch.py", described(f"Node(executable='true', parameters={files})"))
    assert "the parameter 'c' is an empty list, which no parameter file can hold" in capsys.readouterr().out
    assert recorder.exit_code == 0


def test_a_file_that_is_no_yaml_after_its_substitutions(
    record: Recorded, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "p.yaml"
    file.write_text("/**:\n  ros__parameters:\n    a: $(var x)\n")
    record(
        "a.launch.xml",
        f"<launch><let name='x' value='[1, '/>"
        f"<node exec='true'><param from='{file}' allow_substs='true'/></node></launch>",
    )
    shown = capsys.readouterr().out
    assert "cannot be read after its substitutions: it is no YAML: " in shown
    assert "a.launch.xml:1" in shown


@pytest.mark.parametrize(
    ("name", "text", "advice"),
    [
        (
            "a.launch.xml",
            "<launch><node exec='a'><param name='u' value='x: y: z'/></node></launch>",
            '`type="str"`',
        ),
        ("a.launch.yaml", "launch: [node: {exec: a, param: [{name: u, value: '$(var x)'}]}]", "`type: str`"),
    ],
)
def test_advice_is_for_the_kind_of_file(
    name: str, text: str, advice: str, record: Recorded, capsys: pytest.CaptureFixture[str]
) -> None:
    try:
        record(name, text, x="x: y: z")
    except LaunchError as error:
        shown = error.message
    else:
        shown = capsys.readouterr().out
    assert f"{advice} in the `param` passes a text as it is" in shown
    assert "ParameterValue" not in shown


def test_the_environment_is_as_before(record: Recorded) -> None:
    before = dict(os.environ)
    record("a.launch.py", described("GroupAction([UnsetEnvironmentVariable('PATH')])"))
    assert dict(os.environ) == before
