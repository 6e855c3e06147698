"""Each mistake in a launch file is one line with its place, and says what was expected."""

from __future__ import annotations

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from xml.sax.saxutils import quoteattr

import click
import pytest
from ifgen_tools.launching import commands
from launch import LaunchContext, LaunchDescriptionEntity
from launch._errors import LaunchError
from launch.launch_description_sources._reading import read
from launch.substitution import Substitution
from launch_ros.actions import Node

from .conftest import Recorded
from .test_meaning import described

ELEMENTS = [
    ("<group scoped='$(var a)'/>", "'scoped' of 'group' must be true or false"),
    ("<log message='a' level='DEBUG'/>", "`ifgen launch` logs with level INFO only, got 'DEBUG'"),
    ("<set_use_sim_time/>", "'set_use_sim_time' needs the attribute 'value'"),
    (
        "<set_use_sim_time value='perhaps'/>",
        "'value' of 'set_use_sim_time' must be true or false, got 'perhaps'",
    ),
    ("<node exec='a' respawn_delay='-0.1'/>", "'respawn_delay' cannot be negative"),
    ("<node exec='a' respawn_delay='soon'/>", "'respawn_delay' of 'node' must be a number, got 'soon'"),
    ("<node exec='a' on_exit='restart'/>", "'on_exit' must be 'shutdown', got 'restart'"),
    ("<node exec='a' on_exit='$(var b)'/>", "'on_exit' of 'node' cannot have substitutions"),
    ("<node exec='a' args='\"b'/>", "'args' of 'node': no closing quotation"),
    (
        "<node exec='a'><param from='a.yaml' name='b'/></node>",
        "'param' has both 'from' and 'name': one of them",
    ),
    (
        "<node exec='a'><param name='b' value='c'><param name='d' value='e'/></param></node>",
        "'param' has both a value and parameters inside: one of them",
    ),
    ("<node exec='a'><param name='b'/></node>", "'param' needs the attribute 'value'"),
    ("<node exec='a'><param name='b' value='c' type='text'/></node>", "there is no type 'text'"),
    ("<node exec='a' param='b'/>", "'param' of 'node' must be a list of elements"),
    ("<lifecycle_transition/>", "LifecycleTransition needs names of nodes and ids of transitions"),
]


@pytest.mark.parametrize(("element", "message"), ELEMENTS)
def test_elements(element: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "a.launch.xml"
    file.write_text(f"<launch>\n{element}</launch>")
    with pytest.raises(LaunchError) as raised:
        read(str(file))
    assert f"a.launch.xml:2: {message}" in raised.value.message


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("launch:\n- node: [a]", 2, "expected an entity: one key, such as 'node:', with its attributes"),
        ("launch:\n- node: a", 2, "'node' must be a mapping of its attributes, or a list of entities"),
        ("launch:\n- group: {children: a}", 2, "'children' must be a list of entities"),
        ("launch:\n- node: {exec: a, remap: {from: b}}", 2, "'remap' of 'node' must be a value or a list, got a mapping"),
        ("launch:\n- node: {exec: a, remap: [b, {from: c}]}", 2, "a list of values and mappings together"),
        ("launch:\n- {[a]: b}", 2, "a key must be a word"),
        ("launch:\n- node: {<<: {exec: a}}", 2, "merge keys ('<<') are not read in launch files"),
        ("launch:\n- node: {exec: a, param: [{name: b, value: [[c]]}]}", 2, "a list within a list"),
        ("launch:\n- log: {message: !a b}", 2, "this value cannot be read: could not determine a constructor"),
        ("launch:\n- log: {message: 2026-99-99}", 2, "this value cannot be read: month must be in 1..12"),
        ("launch: \x00", 1, "this is not YAML: unacceptable character"),
    ],
)  # fmt: skip
def test_yaml(text: str, line: int, message: str, tmp_path: Path) -> None:
    file = tmp_path / "a.launch.yaml"
    file.write_text(text)
    with pytest.raises(LaunchError) as raised:
        read(str(file))
    assert f"a.launch.yaml:{line}: {message}" in raised.value.message


def test_files(tmp_path: Path) -> None:
    (tmp_path / "a.launch.xml").write_bytes(b"<launch>\n\xff</launch>")
    with pytest.raises(LaunchError, match=r"a\.launch\.xml:2: this file is not UTF-8"):
        read(str(tmp_path / "a.launch.xml"))
    (tmp_path / "a.txt").touch()
    with pytest.raises(LaunchError) as raised:
        read(str(tmp_path / "a.txt"))
    assert raised.value.help == "its name ends in .py, .xml or .yaml"


LINES = [
    ("EmitEvent(event='done')", "EmitEvent expects an event, got 'done'"),
    (
        "ExecuteProcess(cmd=['true'], output={'stdin': 'log'})",
        "output has no stream 'stdin': there are stdout, stderr and both",
    ),
    (
        "ExecuteProcess(cmd=['true'], output={'both': {'paper'}})",
        "output has no place 'paper': there are screen, log and own_log",
    ),
    ("ExecuteProcess(cmd=['true'], output='paper')", "output must be one of screen, log, both, own_log, full, got"),
    ("[one := ExecuteProcess(cmd=['true']), one]", "is executed twice: make an action for each process"),
    (
        "say(Command('echo a', on_stderr='shout'))",
        "on_stderr must be fail, ignore, warn or capture, got 'shout'",
    ),
    ("say(Command('no_such_program_of_mine'))", "cannot run the command 'no_such_program_of_mine': "),
    ("say(Command('sh -c \"echo a >&2; exit 3\"'))", "ended with 3: a"),
    ("say(Command('sh -c \"echo a >&2\"'))", "wrote to stderr: a"),
    ("say(FileContent('/no/such/file'))", "cannot read '/no/such/file': "),
    ("say(FindExecutable(name='no_such_program_of_mine'))", "executable 'no_such_program_of_mine' not found on the PATH"),
    ("TextSubstitution(text=5)", "TextSubstitution expects a text, got 5"),
    ("say(LocalSubstitution('event.nothing'))", "there is no local 'event.nothing' here"),
    ("say(5)", "expected a text, a substitution, or a list of these, got 5"),
    ("say(Parameter('rate'))", "no SetParameter before has set the parameter 'rate'"),
    ("say(EnvironmentVariable('NO_SUCH_VARIABLE'))", "environment variable 'NO_SUCH_VARIABLE' does not exist"),
    (
        "Node(executable='true', namespace='a b')",
        "'a b' is no namespace: expected names of letters, digits and _, with / between them",
    ),
    (
        "Node(executable='true', name='1st')",
        "'1st' is no name of a node: expected letters, digits and _, no digit first",
    ),
    ("Node(executable='true', node_name='a')", "Node has no argument 'node_name': write name"),
    ("Node(executable='true', parameters={'a': 1})", "parameters must be a list of dicts and files, got {'a': 1}"),
    (
        "Node(executable='true', parameters=[5])",
        "expected parameters as a dict or the path of a file, got 5",
    ),
    ("Node(executable='true', parameters=[{'a': b'x'}])", "the parameter 'a' is bytes, which no parameter file can hold"),
    (
        "Node(executable='true', parameters=[{'a': None}])",
        "the parameter 'a': expected a bool, a number, a text, or a list of these, got None; "
        "ParameterValue(..., value_type=str) passes a text as it is",
    ),
    (
        "Node(executable='true', parameters=[{'a': LaunchConfiguration('x', default='[1')}])",
        "the parameter 'a': the text '[1' is no value of a parameter: it is no YAML: ",
    ),
    (
        "Node(executable='true', parameters=[{'a': ParameterValue('1', value_type=list[int])}])",
        "the parameter 'a': the text '1' is no value of a parameter: this is not a list of values",
    ),
    (
        "Node(executable='true', parameters=[ParameterFile('/no/such.yaml', allow_substs=True)])",
        "cannot read the parameter file '/no/such.yaml': ",
    ),
    ("LifecycleTransition(lifecycle_node_names=[], transition_ids=[])", "LifecycleTransition needs names of nodes"),
    (
        "EmitEvent(event=ChangeState(lifecycle_node_matcher=lambda _: True, transition_id=77))",
        "there is no transition 77: lifecycle_msgs/msg/Transition lists them",
    ),
    (
        "IncludeLaunchDescription(os.path.join(os.path.dirname(__file__), 'b.launch.py'))",
        "the included launch file needs the argument 'speed' (how fast), and is given none",
    ),
]  # fmt: skip
INCLUDED = described("DeclareLaunchArgument('speed', description='how fast')")


@pytest.mark.parametrize(("line", "message"), LINES)
def test_lines_of_python(
    line: str, message: str, record: Recorded, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "b.launch.py").write_text(INCLUDED)
    words = f"*{line}" if line.startswith("[") else line
    text = "from launch_ros.events.lifecycle import ChangeState\n" + described(words)
    recorder = record("a.launch.py", text)
    shown = capsys.readouterr().out
    assert recorder.exit_code == 1
    (error,) = (each for each in shown.splitlines() if each.startswith("[ERROR]"))
    assert "a.launch.py:" in error
    assert message in error


class Nameless(Substitution):
    """Of somebody who forgot the method."""


def test_classes_of_users() -> None:
    with pytest.raises(NotImplementedError, match="Nameless does not define perform"):
        Nameless().perform(LaunchContext())
    with pytest.raises(NotImplementedError, match="LaunchDescriptionEntity does not define visit"):
        LaunchDescriptionEntity().visit(LaunchContext())


def test_outside_of_a_launch() -> None:
    from launch.substitutions import SubstitutionFailure, ThisLaunchFile

    with pytest.raises(
        RuntimeError, match="this context belongs to no launch: `ifgen launch FILE` and LaunchService"
    ):
        _ = LaunchContext().host
    with pytest.raises(SubstitutionFailure, match="ThisLaunchFile used outside of a launch file"):
        ThisLaunchFile().perform(LaunchContext())
    with pytest.raises(RuntimeError, match="a node has its name when it is executed, not before"):
        _ = Node(executable="a").node_name


@pytest.mark.parametrize("words", [["f.launch.py", "rate=0.1"], ["p", "f.launch.py", "rate=0.1", "a:=b"]])
def test_an_argument_without_a_colon(words: list[str]) -> None:
    with pytest.raises(click.UsageError, match=r"'rate=0\.1' sets no argument: write rate:=0\.1"):
        commands._split(words)


@pytest.mark.parametrize(
    ("name", "remark"),
    [
        ("rte", "has no argument 'rte': did you mean 'rate'?"),
        ("zzz", "has no argument 'zzz': it has rate"),
        ("rate", ""),
        ("late", ""),
        ("transport", ""),
    ],
)
def test_an_argument_that_nobody_declares(name: str, remark: str, record: Recorded, tmp_path: Path) -> None:
    """One that the file mentions may be read by its functions."""
    recorder = record(
        "a.launch.py",
        described(
            "DeclareLaunchArgument('rate', default_value='1'), say(LaunchConfiguration('late', default=''))"
        ),
    )
    path = str(tmp_path / "a.launch.py")
    found = commands._unknown(name, read(path), path, recorder)
    assert found == (f"{path} {remark}" if remark else "")


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["a.launch.py"], 1, "there is no launch file 'a.launch.py'\n  = help: for a file of a package, write its"),
        (["a", "b", "c"], 2, "unexpected 'c': arguments are NAME:=VALUE, and FILE comes first"),
        (["a", ":=5"], 2, "the argument ':=5' has no name: arguments are NAME:=VALUE"),
        (["bringup", "b.launch.py"], 1, "has no file 'b.launch.py'\n  = help: it has a.launch.py, a.launch.py"),
        (["bringup", "a.launch.py"], 1, "has 'a.launch.py' twice: "),
    ],
    ids=range(5),
)  # fmt: skip
def test_command_line(words: list[str], code: int, message: str, tmp_path: Path) -> None:
    if "rclpy" in " ".join(words) and find_spec("rclpy") is None:
        pytest.skip("there is no real rclpy")
    for folder in ("src/bringup/launch", "src/bringup/old"):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "a.launch.py").touch()
    (tmp_path / "src/bringup/package.xml").write_text("<package format='3'><name>bringup</name></package>")
    (tmp_path / "x.py").touch()
    command = [sys.executable, "-m", "ifgen", "launch", *words]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout) == (code, "")
    assert done.stderr.startswith("error: ")
    assert message in done.stderr


KINDS_OF_VALUES = (
    *("text", "5", "1e400", "9" * 5000, ".nan", "null", "2026-01-31", "12:30:45", "{}", "a: b", "{a: b}", "[]", "[1, a]"),
    *("[[1]]", "[{}]", "[null]", "[1", '"', '"a\\0b"', '"\\ud800"', "[" * 200, "*a", "&a [*a]", "!!binary AQ==", "%", "@"),
    *("!!set {a}", "!!python/object:os.system x", "!!int x", "- a\n- b", "'é'", "<<", "=", "? [a]\n: b"),
)  # fmt: skip


@pytest.mark.parametrize("value", KINDS_OF_VALUES, ids=[ascii(value)[:20] for value in KINDS_OF_VALUES])
def test_every_kind_of_value(value: str, record: Recorded, capsys: pytest.CaptureFixture[str]) -> None:
    """A parameter takes it, or one line says why not, in each kind of launch file."""
    made = f"Node(executable='true', parameters=[{{'p': LaunchConfiguration('x', default={value!r})}}])"
    files = {
        "a.launch.py": described(made),
        "a.launch.xml": f"<launch><node exec='true'><param name='p' value={quoteattr(value)}/></node></launch>",
        "a.launch.yaml": f"launch: [node: {{exec: 'true', param: [{{name: p, value: {value}}}]}}]",
    }
    for name, text in files.items():
        try:
            recorder = record(name, text)
        except LaunchError as error:
            said = [error.message]
        else:
            said = [line for line in capsys.readouterr().out.splitlines() if line.startswith("[ERROR]")]
            assert len(said) == recorder.exit_code, (name, said)
        assert all("Error: " not in line and len(line) < 600 for line in said), (name, said)
