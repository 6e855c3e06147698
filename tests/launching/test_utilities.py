"""What programs import of launch besides actions: typed values, entities, signals, names and parameters."""

from __future__ import annotations

import asyncio
import os
import signal
import typing
from pathlib import Path
from typing import Any

import pytest
from launch import LaunchContext, LaunchDescription, LaunchService
from launch.actions import (
    EmitEvent,
    ExecuteProcess,
    LogInfo,
    OpaqueFunction,
    RegisterEventHandler,
    ReplaceEnvironmentVariables,
    Shutdown,
)
from launch.event import Event
from launch.event_handlers import OnIncludeLaunchDescription, event_named
from launch.events import IncludeLaunchDescription
from launch.frontend.parse_substitution import parse_if_substitutions
from launch.launch_description_sources import load_python_launch_file_as_module
from launch.substitutions import EnvironmentVariable, TextSubstitution
from launch.utilities import (
    AsyncSafeSignalManager,
    create_future,
    ensure_argument_type,
    is_a,
    is_a_subclass,
    isclassinstance,
    normalize_to_list_of_entities,
    perform_substitutions,
    visit_all_entities_and_collect_futures,
)
from launch.utilities import type_utils as types
from launch_ros import utilities as ros
from launch_ros.actions import ROSTimer
from launch_ros.parameter_descriptions import ParameterValue
from launch_testing.actions import PyTest, Test
from launch_testing.event_handlers import StdoutReadyListener

from tests.launching.conftest import Recorder

Text = TextSubstitution
_LIST: Any = typing.List  # noqa: UP006 - what programs write, which is not `list`


@pytest.mark.parametrize(
    ("text", "kind", "expected"),
    [
        ("asd", None, "asd"),
        ("tRuE", None, "tRuE"),
        ("'1'", None, "1"),
        ("1000", None, 1000),
        ("1.", None, 1.0),
        ("off", None, False),
        ("[.2, .1]", None, [0.2, 0.1]),
        ("[on, no]", None, [True, False]),
        ("'1'", str, "'1'"),
        ("{1}", str, "{1}"),
        ("1", float, 1.0),
        ("[asd, bsd]", list[str], ["asd", "bsd"]),
        (["1.", "1000."], None, [1.0, 1000.0]),
        (["1000.", "1000"], list[float], [1000.0, 1000.0]),
    ],
)
def test_what_texts_stand_for(text: Any, kind: Any, expected: Any) -> None:
    found = types.get_typed_value(text, kind)
    assert (found, type(found)) == (expected, type(expected))


@pytest.mark.parametrize(
    ("text", "kind", "error"),
    [
        ("''1''", None, ValueError),
        ("{1}", None, ValueError),
        ("[1, 2.0]", None, ValueError),
        ("1000.5", int, ValueError),
        ("1", bool, ValueError),
        ("[1, 2.0]", list[float], ValueError),
        (["1000.", "1000"], None, ValueError),
        (["asd", "True"], list[bool], ValueError),
        (["1", "2"], int, TypeError),
        ([1, 2], None, TypeError),
        ({"a"}, None, TypeError),
        ("a", bytes, ValueError),
    ],
)
def test_texts_that_stand_for_nothing(text: Any, kind: Any, error: type[Exception]) -> None:
    with pytest.raises(error):
        types.get_typed_value(text, kind)


def test_texts_in_place_of_values() -> None:
    assert types.coerce_to_type("asd", float, can_be_str=True) == "asd"
    assert types.coerce_to_type("[asd, 2.0]", list[float], can_be_str=True) == ["asd", 2.0]
    assert types.coerce_list(["asd", "off", "True"], can_be_str=True) == ["asd", False, True]
    assert types.is_instance_of_valid_type([1.0, "2."], can_be_str=True)
    assert not types.is_instance_of_valid_type([1, "2", 1.0], can_be_str=True)
    assert types.is_instance_of(["1", 2], list[int], can_be_str=True)
    assert not types.is_instance_of([1, 2.0], list[int], can_be_str=True)
    assert not types.is_instance_of(1, float)
    assert not types.is_instance_of(True, int)
    for wrong in (bytes, _LIST, list, int | str):
        with pytest.raises(ValueError):
            types.is_instance_of([1], wrong)
    assert types.is_typing_list(_LIST) and not types.is_typing_list(list)
    assert types.extract_type(list[str]) == (str, True)


def test_substitutions_of_a_type() -> None:
    context = LaunchContext()
    assert types.is_substitution(["a", Text(text="b")]) and not types.is_substitution(["a", "b"])
    assert types.normalize_typed_substitution(1, int) == 1
    mixed = types.normalize_typed_substitution([Text(text="1"), 2], list[int])
    assert types.is_normalized_substitution(mixed[0])
    assert types.perform_typed_substitution(context, mixed, list[int]) == [1, 2]
    whole = types.normalize_typed_substitution([Text(text="[1"), ", 2]"], list[int])
    assert types.perform_typed_substitution(context, whole, list[int]) == [1, 2]
    for value, kind in ((1, str), ([Text(text="1"), 2.0], list[int]), ([Text(text="1"), 2], int)):
        with pytest.raises(TypeError):
            types.normalize_typed_substitution(value, kind)
    with pytest.raises(ValueError):
        types.perform_typed_substitution(context, [Text(text="x")], int)


def test_classes_and_arguments() -> None:
    assert is_a(1, int) and is_a_subclass(bool, int) and not is_a_subclass(1, int)
    assert isclassinstance(LaunchContext()) and not isclassinstance(LaunchContext) and not isclassinstance(1)
    ensure_argument_type(1, (int, str), "count")
    with pytest.raises(TypeError, match=r"f\(\) expected 'count' to be int or str, got 1\.5"):
        ensure_argument_type(1.5, [int, str], "count", "f()")
    with pytest.raises(TypeError, match="a class or several"):
        ensure_argument_type(1, ["int"], "count")  # type: ignore[list-item]


def test_entities_and_futures() -> None:
    async def check() -> None:
        future = create_future(None)
        assert not future.done()
        assert create_future(asyncio.get_running_loop()).get_loop() is future.get_loop()

    asyncio.run(check())
    seen: list[int] = []
    inner = OpaqueFunction(function=lambda _: seen.append(2))
    outer = OpaqueFunction(function=lambda _: (seen.append(1), [inner])[1])
    service = LaunchService()
    assert visit_all_entities_and_collect_futures(LaunchDescription([outer]), service.context) == []
    assert seen == [1, 2]
    assert normalize_to_list_of_entities(inner) == [inner]
    assert normalize_to_list_of_entities(None) == []
    with pytest.raises(TypeError):
        normalize_to_list_of_entities(["text"])  # type: ignore[list-item]


@pytest.mark.skipif(os.name == "nt", reason="there are no such signals")
def test_signals_call_within_the_loop() -> None:
    said: list[Any] = []
    before = signal.signal(signal.SIGUSR1, lambda *_: said.append("before"))
    loop = asyncio.new_event_loop()
    try:
        manager = AsyncSafeSignalManager(loop)
        assert manager.handle(signal.SIGUSR1, said.append) is None

        def raised() -> list[Any]:
            said.clear()
            signal.raise_signal(signal.SIGUSR1)
            loop.run_until_complete(asyncio.sleep(0))
            return list(said)

        assert raised() == ["before"]
        for _ in range(2):
            with manager:
                assert raised() == [signal.SIGUSR1]
            assert raised() == ["before"]
        with manager:
            manager.handle(signal.SIGUSR1, None)
            assert raised() == ["before"]
    finally:
        signal.signal(signal.SIGUSR1, before)
        loop.close()


def test_events_and_environments(monkeypatch: pytest.MonkeyPatch) -> None:
    class Mine(Event):
        name = "mine"

    said: list[str] = []
    note = OpaqueFunction(function=lambda context: said.append(dict(context.environment).get("A", "")))
    service = LaunchService()
    monkeypatch.setenv("B", "1")
    included = LaunchDescription([note])
    service.include_launch_description(
        LaunchDescription(
            [
                ReplaceEnvironmentVariables({"A": ["b", EnvironmentVariable("B")]}),
                EmitEvent(event=IncludeLaunchDescription(included)),
            ]
        )
    )
    assert service.run() == 0
    assert said == ["b1"]
    assert dict(service.context.environment) == {"A": "b1"}
    handler, event = OnIncludeLaunchDescription(), IncludeLaunchDescription(included)
    assert handler.matches(event) and not handler.matches(Mine())
    assert handler.handle(event, service.context) == [included]
    assert event_named("mine")(Mine()) and not event_named("other")(Mine())


def test_files_and_attributes(tmp_path: Path) -> None:
    file = tmp_path / "a.launch.py"
    file.write_text("VALUE = 3\n")
    assert load_python_launch_file_as_module(str(file)).VALUE == 3
    assert not list(tmp_path.glob("__pycache__"))
    context = LaunchContext()
    (text, number) = parse_if_substitutions(["a$(env HOME x)", 3])
    assert perform_substitutions(context, text).startswith("a")
    assert number == 3


def test_names_of_nodes() -> None:
    context = LaunchContext()
    assert [ros.add_node_name(context, "/a"), ros.add_node_name(context, "/a", 2)] == [1, 3]
    assert ros.get_node_name_count(context, "/b") == 0
    assert ros.is_root_namespace("/") and not ros.is_root_namespace("")
    assert ros.is_namespace_absolute("/a") and not ros.is_namespace_absolute("a")
    ((old, new),) = ros.normalize_remap_rules([("a", [Text(text="b"), "c"])])
    assert (perform_substitutions(context, old), perform_substitutions(context, new)) == ("a", "bc")
    with pytest.raises(TypeError, match="must be a list of pairs"):
        list(ros.normalize_remap_rules({"a": "b"}))
    with pytest.raises(TypeError, match="a pair"):
        ros.normalize_remap_rule("ab")


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        (["/foo", Path("/bar")], (Path("/foo"), Path("/bar"))),
        ([(Text(text="/foo"), Text(text="/bar"))], (Path("/foo/bar"),)),
        ([{"foo": 1, "bar": {"x": 2.0}}], ({"foo": 1, "bar.x": 2.0},)),
        ([{Text(text="false"): Text(text="off")}], ({"false": False},)),
        ([{"a": [Text(text="fiz"), Text(text="buz")]}], ({"a": "fizbuz"},)),
        ([{"a": [[Text(text="1")], [Text(text="2")]]}], ({"a": (1, 2)},)),
        ([{"a": Text(text="[2, 3]")}], ({"a": (2, 3)},)),
        ([{"a": [2, 3.5]}], ({"a": (2.0, 3.5)},)),
        ([{"a": b"\xff"}], ({"a": b"\xff"},)),
        ([{"a": ParameterValue(Text(text="{'b': 3}"), value_type=str)}], ({"a": "{'b': 3}"},)),
    ],
)
def test_parameters(given: Any, expected: Any) -> None:
    assert ros.evaluate_parameters(LaunchContext(), ros.normalize_parameters(given)) == expected


@pytest.mark.parametrize("wrong", [{"foo": "bar"}, "foobar", [3]])
def test_parameters_that_are_none(wrong: Any) -> None:
    with pytest.raises(TypeError):
        ros.normalize_parameters(wrong)


def test_tests_and_readiness() -> None:
    ready: list[str] = []
    talker = ExecuteProcess(cmd=["sh", "-c", "printf rea; printf dy"])
    then = [OpaqueFunction(function=lambda _: ready.append("ready"))]
    service = LaunchService()
    listener = StdoutReadyListener(target_action=talker, ready_txt="ready", actions=then)
    service.include_launch_description(LaunchDescription([RegisterEventHandler(listener), talker]))
    assert service.run() == 0
    assert ready == ["ready"]
    recorder = Recorder()
    recorder.include_launch_description(LaunchDescription([PyTest(path="test_a.py")]))
    recorder.run()
    (process,) = recorder.started
    assert process.command[1:] == ["-m", "pytest", "test_a.py"]


@pytest.mark.parametrize(("seconds", "timeout", "code"), [(0, 1000.0, 0), (1000, 0.01, -signal.SIGINT)])
def test_a_test_has_its_time(seconds: int, timeout: float, code: int) -> None:
    program = Test(cmd=["sleep", str(seconds)], timeout=timeout)
    service = LaunchService()
    service.include_launch_description(LaunchDescription([program]))
    service.run()
    assert program.return_code == code


def test_a_timer_on_the_clock_of_ros(capfd: Any) -> None:
    service = LaunchService()
    actions = [LogInfo(msg="rang"), Shutdown()]
    service.include_launch_description(LaunchDescription([ROSTimer(period=0.01, actions=actions)]))
    assert service.run() == 0
    assert "rang" in capfd.readouterr().out
