"""LaunchService and the parts of launch that programs of users call, and launch files written for upstream's."""

from __future__ import annotations

import asyncio
import importlib
import io
import subprocess
import sys
from pathlib import Path
from typing import Any

import launch
import pytest
from launch import LaunchDescription, LaunchIntrospector, LaunchService, logging
from launch._errors import LaunchError
from launch.actions import (
    EmitEvent,
    ExecuteLocal,
    ExecuteProcess,
    ForEach,
    ForLoop,
    LogInfo,
    OpaqueCoroutine,
    RegisterEventHandler,
    TimerAction,
)
from launch.descriptions import Executable
from launch.event_handlers import OnExecutionComplete, OnProcessExit, OnProcessIO
from launch.events import Shutdown, matches_action
from launch.events.process import ProcessIO, SignalProcess, matches_name
from launch.frontend import Entity, Parser, expose_action, expose_substitution
from launch.substitution import Substitution
from launch.substitutions import EqualsSubstitution, IfElseSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

from .conftest import Recorded


@pytest.fixture
def service() -> LaunchService:
    logging.reset()
    return LaunchService()


def described(text: str) -> LaunchDescription:
    root, parser = Parser.load(io.StringIO(text))
    return parser.parse_description(root)


def test_a_program_runs_a_description(service: LaunchService, capsys: pytest.CaptureFixture[str]) -> None:
    seen: list[bytes] = []
    done: list[str] = []
    process = ExecuteLocal(
        process_description=Executable(cmd=["sh", "-c", "echo out; echo err >&2; exit 3"], name="mine"),
        output="screen",
    )
    handlers = [
        OnProcessIO(
            target_action=process,
            on_stdout=lambda event: seen.append(event.text),
            on_stderr=lambda event: seen.append(event.text),
        ),
        OnProcessExit(target_action=process, on_exit=lambda event, _: done.append(str(event.returncode))),
        OnExecutionComplete(target_action=process, on_completion=lambda event, _: done.append("completed")),
    ]
    entities = [*map(RegisterEventHandler, handlers), process]
    service.include_launch_description(LaunchDescription(entities))
    assert service.run() == 0
    assert (sorted(seen), done, service.exit_code) == ([b"err\n", b"out\n"], ["3", "completed"], 3)
    future = process.get_asyncio_future()
    assert future is not None
    assert future.done()
    assert any(
        line.startswith("[mine-") and line.endswith("] out") for line in capsys.readouterr().out.splitlines()
    )


def test_a_launch_in_the_loop_of_the_program(service: LaunchService) -> None:
    said: list[str] = []

    async def act(context: launch.LaunchContext, word: str) -> None:
        await asyncio.sleep(0)
        said.append(word)
        await context.emit_event(SignalProcess(signal_number="SIGTERM", process_matcher=matches_name("no")))

    async def main() -> int:
        timer = TimerAction(period=0.01, actions=[OpaqueCoroutine(coroutine=act, args=["late"])])
        service.include_launch_description(
            LaunchDescription([OpaqueCoroutine(coroutine=act, args=["first"]), timer])
        )
        return await service.run_async()

    assert asyncio.run(main()) == 0
    assert said == ["first", "late"]


def test_a_service_waits_until_it_is_ended(service: LaunchService) -> None:
    async def main() -> int:
        asyncio.get_running_loop().call_later(0.05, service.shutdown)
        return await service.run_async(shutdown_when_idle=False)

    assert asyncio.run(asyncio.wait_for(main(), 20)) == 0


def test_mistakes_end_the_launch(service: LaunchService, capsys: pytest.CaptureFixture[str]) -> None:
    async def fail() -> None:
        raise ValueError("of a coroutine")

    entities = [OpaqueCoroutine(coroutine=fail, ignore_context=True)]
    service.include_launch_description(LaunchDescription(entities))
    assert service.run() == 1
    assert "of a coroutine" in capsys.readouterr().out


def test_a_signal_reaches_the_processes_that_match(service: LaunchService) -> None:
    sleeper = ExecuteProcess(cmd=["sleep", "100"])
    other = ExecuteProcess(cmd=["true"])
    stop = SignalProcess(signal_number="SIGKILL", process_matcher=matches_action(sleeper))
    handler = OnProcessExit(target_action=other, on_exit=EmitEvent(event=stop))
    service.include_launch_description(LaunchDescription([RegisterEventHandler(handler), sleeper, other]))
    service.run()
    assert (sleeper.return_code, other.return_code) == (-9, 0)


def test_loops(service: LaunchService, capsys: pytest.CaptureFixture[str]) -> None:
    each = ForEach("{a: x};{a: y}", function=lambda a: LogInfo(msg=f"each {a}"))
    loop = ForLoop("2", function=lambda i: LogInfo(msg=f"loop {i}"))
    service.include_launch_description(LaunchDescription([each, loop]))
    service.run()
    said = [line.partition("]: ")[2] for line in capsys.readouterr().out.splitlines() if "user" in line]
    assert said == ["each x", "each y", "loop 0", "loop 1"]


@expose_action("greet")
class Greet(LogInfo):
    """An action of a user."""

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Any:
        kwargs: dict[str, Any] = {}
        kwargs["msg"] = [*parser.parse_substitution(entity.get_attr("who")), "!"]
        assert entity.get_attr("times", data_type=int, optional=True) in {None, 2}
        assert [
            each.get_attr("a")
            for each in entity.get_attr("word", data_type=list[Entity], optional=True) or ()
        ]
        return cls, kwargs


@expose_substitution("twice")
class Twice(Substitution):
    """A substitution of a user."""

    def __init__(self, parts: Any) -> None:
        self._parts = parts

    @classmethod
    def parse(cls, data: Any) -> Any:
        return cls, {"parts": data[0]}

    def perform(self, context: launch.LaunchContext) -> str:
        return 2 * "".join(part.perform(context) for part in self._parts)


@pytest.mark.parametrize(
    "text",
    [
        "<launch><greet who='$(twice ab)' times='2'><word a='1'/></greet></launch>",
        "launch:\n- greet: {who: $(twice ab), times: 2, word: [{a: '1'}]}",
    ],
)
def test_actions_and_substitutions_of_users(
    text: str, service: LaunchService, capsys: pytest.CaptureFixture[str]
) -> None:
    service.include_launch_description(described(text))
    assert service.run() == 0
    assert "abab!" in capsys.readouterr().out


def test_entities_say_what_they_do_not_have() -> None:
    root, _ = Parser.load(io.StringIO("<launch><a x='5' y='b'/></launch>"))
    (entity,) = root.children
    assert (entity.type_name, entity.parent, entity.get_attr("x", data_type=float)) == ("a", root, 5.0)
    assert entity.get_attr("y", data_type=int) == "b"
    with pytest.raises(TypeError, match="'y' of 'a' must be of type int, got 'b'"):
        entity.get_attr("y", data_type=int, can_be_str=False)
    with pytest.raises(AttributeError, match="'a' needs the attribute 'z'"):
        entity.get_attr("z")


@pytest.mark.parametrize("value", ["yes", "on", "True", "1"])
def test_truths(value: str, record: Recorded) -> None:
    text = f"<launch><log message='a' if='{value}'/><group scoped='{value}'><log message='b' unless='off'/></group></launch>"
    assert record("a.launch.xml", text).said == ["a", "b"]


def test_a_deprecated_file_says_so(record: Recorded) -> None:
    said = record("a.launch.xml", "<launch deprecated='use b'><log message='a'/></launch>").said
    assert said == ["this launch description is deprecated: use b", "a"]


NODES = """
from launch import LaunchDescription
from launch.actions import LogInfo
from launch_ros.actions import ComposableNodeContainer, LoadComposableNodes
from launch_ros.descriptions import ComposableNode
def generate_launch_description():
    node = ComposableNode(package='p', plugin='p::Camera', name='camera', parameters=[{'rate': 5}])
    other = ComposableNode(package='p', plugin='p::Filter')
    container = ComposableNodeContainer(
        package='no_components', executable='component_container', name='c', namespace='',
        composable_node_descriptions=[node])
    more = LoadComposableNodes(target_container='/c', composable_node_descriptions=[other])
    return LaunchDescription([container, more, LogInfo(msg='the rest')])
"""
AS_XML = """<launch>
<node_container pkg='no_components' exec='component_container' name='c' namespace=''>
  <composable_node pkg='p' plugin='p::Camera' name='camera'><param name='rate' value='5'/></composable_node>
</node_container>
<load_composable_node target='/c'><composable_node pkg='p' plugin='p::Filter'/></load_composable_node>
<log message='the rest'/>
</launch>"""


@pytest.mark.parametrize(("name", "text"), [("a.launch.py", NODES), ("a.launch.xml", AS_XML)])
def test_where_no_container_is_installed_the_rest_runs(name: str, text: str, record: Recorded) -> None:
    recorder = record(name, text)
    first, second, rest = recorder.said
    assert first == (
        "the composable nodes camera do not run: no container runs: there is no package 'no_components'"
    )
    assert second == "the composable nodes p::Filter do not run: the container '/c' does not run"
    assert (rest, recorder.exit_code) == ("the rest", 0)


def test_show_args_shows_those_of_an_included_file_with_composable_nodes(tmp_path: Path) -> None:
    argument = "DeclareLaunchArgument('speed', default_value='1', description='how fast')"
    inner = NODES.replace("LaunchDescription([", f"LaunchDescription([{argument}, ").replace(
        "import LogInfo", "import LogInfo, DeclareLaunchArgument"
    )
    (tmp_path / "inner.launch.py").write_text(inner)
    (tmp_path / "a.launch.xml").write_text("<launch><include file='$(dirname)/inner.launch.py'/></launch>")
    command = [sys.executable, "-m", "ifgen", "launch", "--transport", "local", "a.launch.xml", "--show-args"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert "    'speed':\n        how fast\n        (default: '1')" in done.stdout


def test_what_upstream_refuses_is_refused() -> None:
    with pytest.raises(
        TypeError, match=r"remappings must be a list of pairs \(from, to\), got \{'ab': 'cd'\}"
    ):
        Node(executable="a", remappings={"ab": "cd"})  # type: ignore[arg-type]
    with pytest.raises(RuntimeError, match="IfElseSubstitution needs an if_value or an else_value"):
        IfElseSubstitution("true")
    with pytest.raises(LaunchError, match="has no action 'nothing'"):
        described("<launch><nothing/></launch>")
    assert EqualsSubstitution(None, "").perform(launch.LaunchContext()) == "true"


def test_packages_are_found_without_a_launch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    index = tmp_path / "share/ament_index/resource_index/packages"
    index.mkdir(parents=True)
    (index / "mine").touch()
    (tmp_path / "share/mine").mkdir()
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    assert FindPackageShare("mine").find("mine") == str(tmp_path / "share/mine")
    assert (FindPackageShare("mine") / "a").perform(launch.LaunchContext()) == str(tmp_path / "share/mine/a")


@pytest.mark.parametrize(
    "name",
    [
        "launch.actions.execute_process.ExecuteProcess",
        "launch.actions.include_launch_description.IncludeLaunchDescription",
        "launch.substitutions.path_join_substitution.PathJoinSubstitution",
        "launch.event_handlers.on_process_exit.OnProcessExit",
        "launch.launch_description_sources.python_launch_description_source.PythonLaunchDescriptionSource",
        "launch.events.shutdown.Shutdown",
        "launch_ros.actions.node.Node",
        "launch_ros.actions.ros_timer.RosTimer",
        "launch_ros.substitutions.find_package.FindPackageShare",
        "launch_ros.descriptions.composable_node.ComposableNode",
    ],
)
def test_names_in_the_modules_where_upstream_has_them(name: str) -> None:
    module, _, short = name.rpartition(".")
    assert getattr(importlib.import_module(module), short).__name__ == short


def test_log_files_have_what_the_screen_shows(tmp_path: Path, service: LaunchService) -> None:
    config = logging.launch_config
    config.log_dir = str(tmp_path / "logs")
    stdout, _ = logging.get_output_loggers("talker-1", "full")
    stdout.info("a line")
    logging.get_logger("mine").warning("careful")
    config.close()
    assert "[talker-1] a line" in (tmp_path / "logs/launch.log").read_text()
    assert "[WARNING] [mine]: careful" in (tmp_path / "logs/launch.log").read_text()
    assert (tmp_path / "logs/talker-1-stdout.log").read_text() == "a line\n"
    with pytest.raises(ValueError, match="output must be one of screen, log, both, own_log, full"):
        logging.get_output_loggers("x", "paper")


def test_descriptions_as_trees() -> None:
    text = LaunchIntrospector().format_launch_description(LaunchDescription([LogInfo(msg="a")]))
    assert text == "LaunchDescription\n└── LogInfo"
    assert ProcessIO(text=b"", fd=1, action=None, name="", cmd=[], cwd=None, env=None, pid=1).from_stdout  # type: ignore[arg-type]
    assert Shutdown().reason == "reason not given"
