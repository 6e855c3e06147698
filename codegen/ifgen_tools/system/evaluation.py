"""Launch descriptions evaluated without a start: conditions, arguments, scopes, remaps and parameters.

Whatever a launch file in Python does when it is read, it does here, too. Nothing that it describes starts.
"""
# What launch files say is Any.
# pyright: reportUnknownArgumentType=false, reportUnknownMemberType=false, reportUnknownVariableType=false

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

from ifgen.diagnostics import Diagnostic, InputError, Label, Span
from launch import LaunchContext, LaunchDescriptionEntity
from launch._errors import LaunchError, explained
from launch.action import Action
from launch.actions import (
    EmitEvent,
    ExecuteLocal,
    IncludeLaunchDescription,
    LogInfo,
    OpaqueCoroutine,
    RegisterEventHandler,
    TimerAction,
)
from launch.conditions import evaluate_condition_expression
from launch.event import Event
from launch.launch_context import Packages, ProcessToStart
from launch.substitutions import Command as CommandSubstitution
from launch.utilities import performed
from launch_ros.actions import (
    ComposableNodeContainer,
    LifecycleNode,
    LifecycleTransition,
    LoadComposableNodes,
    Node,
    SetParameter,
    SetParametersFromFile,
    SetRemap,
)
from launch_ros.descriptions import ComposableNode
from launch_ros.events.lifecycle import ChangeState
from launch_ros.parameter_descriptions import Parameter as ParameterAction
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue, Text, typed
from launch_ros.utilities import evaluate_one, make_namespace_absolute, prefix_namespace

from ifgen_tools.launching.packages import UserPackages
from ifgen_tools.system.model import Command, NodeKind, Remap
from ifgen_tools.system.places import Place, Places

MAX_INCLUDES: Final = 40
"""Launch files within launch files; more of them are files that include each other."""
_MAX_DEPTH: Final = 150


@dataclass(frozen=True, slots=True)
class GivenValues:
    """Parameters that a launch file spells out; a value is None where only a run tells it."""

    values: Mapping[str, Any]
    span: Span | None


@dataclass(frozen=True, slots=True)
class GivenFile:
    """A parameter file that a node gets, and the place in the launch file that says so."""

    path: Path
    span: Span | None
    text: str | None = None
    """Its text where the launch file replaces substitutions in it."""


@dataclass(frozen=True, slots=True)
class LaunchedNode:
    """A node that a description starts. `name` is empty where only its executable knows it."""

    package: str
    executable: str
    name: str
    namespace: str
    kind: NodeKind
    remaps: tuple[Remap, ...]
    parameters: tuple[GivenValues | GivenFile, ...]
    arguments: tuple[str, ...] = ()
    is_managed: bool = False
    missing: LaunchError | None = None
    """The reason why its executable cannot be started."""
    place: Place | None = None
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Launched:
    """All that a description starts, and the last parts of the names of nodes that its transitions manage."""

    nodes: tuple[LaunchedNode, ...]
    commands: tuple[Command, ...]
    managed: frozenset[str] = frozenset()


class PackagesWithoutPython(UserPackages):
    """Finds packages, and refuses launch files in Python."""

    def near(self, path: str) -> None:
        """Note that a launch file is read. Raises LaunchError for one in Python."""
        if path.endswith(".py"):
            message = f"'{path}' is Python, which --no-python does not run"
            raise LaunchError(message, help="leave that option out, or name other files")
        super().near(path)


@dataclass
class _Later:
    """A call that comes as soon as the rest is evaluated."""

    call: Callable[[], None] | None

    def cancel(self) -> None:
        """Do not make it."""
        self.call = None

    def fire(self) -> None:
        """Make it now."""
        call, self.call = self.call, None
        if call is not None:
            call()


@dataclass
class Evaluation:
    """The host of a description that runs nothing, and notes what would start."""

    packages: Packages
    with_python: bool = True
    places: Places = field(default_factory=Places)
    _nodes: list[LaunchedNode] = field(default_factory=list[LaunchedNode])
    _commands: list[Command] = field(default_factory=list[Command])
    _managed: set[str] = field(default_factory=set[str])
    _lifecycle: list[LifecycleNode] = field(default_factory=list[LifecycleNode])
    _transitions: list[ChangeState] = field(default_factory=list[ChangeState])
    _calls: deque[_Later] = field(default_factory=deque[_Later])
    _ends: list[Callable[[], None]] = field(default_factory=list[Callable[[], None]])
    _remaps: dict[tuple[str, str], Place | None] = field(
        default_factory=dict[tuple[str, str], "Place | None"]
    )
    _globals: dict[str, Place | None] = field(default_factory=dict[str, "Place | None"])
    _includes: list[IncludeLaunchDescription] = field(default_factory=list[IncludeLaunchDescription])
    _depth: int = 0

    def evaluate(self, path: Path, arguments: Mapping[str, str]) -> Launched:
        """Everything that a launch file starts with these arguments. Raises InputError with all places."""
        self.context = LaunchContext(
            argv=[f"{name}:={value}" for name, value in arguments.items()], noninteractive=True
        )
        self.context.packages = self.packages
        self.context.runs_programs = False
        self.context.runs_python = self.with_python
        self.context.host = self
        # What a description changes of the environment is no business of ours.
        self.context.environment = dict(self.context.environment)
        include = IncludeLaunchDescription(str(path), launch_arguments=list(arguments.items()))
        include.place = None
        try:
            self.visit([include])
            while self._calls:
                self._calls.popleft().fire()
        except SystemExit as error:
            ended = RuntimeError(f"SystemExit: {error}").with_traceback(error.__traceback__)
            raise InputError([self._explained(explained(ended))]) from error
        except Exception as error:
            raise InputError([self._explained(explained(error))]) from error
        finally:
            for end in self._ends:
                end()
            self.context.files.close()
        for event in self._transitions:
            self._managed.update(node.expanded_node_name for node in self._lifecycle if _matches(event, node))
        return Launched(tuple(self._nodes), tuple(self._commands), frozenset(self._managed))

    def visit(self, entities: Sequence[LaunchDescriptionEntity]) -> None:
        """Evaluate entities, and what they return, in their order. Raises LaunchError."""
        self._depth += 1
        try:
            for entity in entities:
                try:
                    following = self._following(entity)
                except Exception as error:
                    raise explained(error, entity.place) from error
                if following and self._depth > _MAX_DEPTH:
                    raise LaunchError("launch files include each other without an end", entity.place)
                self.visit(following or ())
                if self._includes and entity is self._includes[-1]:
                    self._includes.pop()
        finally:
            self._depth -= 1

    def _following(self, entity: LaunchDescriptionEntity) -> Sequence[LaunchDescriptionEntity] | None:
        """The entities to evaluate after one."""
        if isinstance(entity, Action) and entity.condition and not entity.condition.evaluate(self.context):
            return None
        match entity:
            case ComposableNodeContainer():
                self._node(entity, "container")
                self._components(entity.composable_node_descriptions, entity.place)
            case LoadComposableNodes():
                self._components(entity.composable_node_descriptions, entity.place)
            case Node():
                self._node(entity, "process")
            case ExecuteLocal():
                words = (performed(self.context, word) for word in entity.cmd)
                self._commands.append(Command(tuple(words), self.places.span(entity.place)))
            case TimerAction():
                return entity.actions
            case RegisterEventHandler():
                return entity.event_handler.entities  # what answers an event may come
            case EmitEvent(event=ChangeState() as event):
                self._transitions.append(event)
            case LifecycleTransition():
                names = (performed(self.context, each) for each in entity.lifecycle_node_names)
                self._managed.update(name.rpartition("/")[2] for name in names)
            case EmitEvent() | OpaqueCoroutine() | LogInfo():
                pass
            case IncludeLaunchDescription():
                return self._include(entity)
            case _:
                self._note_defaults(entity)
                return entity.visit(self.context)
        return None

    def _include(self, entity: IncludeLaunchDescription) -> Sequence[LaunchDescriptionEntity]:
        self._includes.append(entity)
        if len(self._includes) > MAX_INCLUDES:
            raise LaunchError("launch files include each other without an end", entity.place)
        return entity.execute(self.context)

    def _note_defaults(self, entity: LaunchDescriptionEntity) -> None:
        """Note where the defaults of the nodes that follow are said."""
        if isinstance(entity, SetRemap):
            key = (performed(self.context, entity.src), performed(self.context, entity.dst))
            self._remaps[key] = entity.place
        elif isinstance(entity, SetParameter):
            self._globals[performed(self.context, entity.name)] = entity.place
        elif isinstance(entity, SetParametersFromFile):
            self._globals[str(evaluate_one(self.context, entity.filename))] = entity.place

    def _node(self, node: Node, kind: NodeKind) -> None:
        node.expand_names(self.context)
        executable = performed(self.context, node.executable)
        package = "" if node.package is None else performed(self.context, node.package)
        words = [performed(self.context, each) for each in node.arguments]
        ros_words = (performed(self.context, each) for each in node.ros_arguments)
        own = _of_words([*words, "--ros-args", *ros_words])
        name, namespace = node.expanded_node_name, node.expanded_node_namespace
        name = "" if name == Node.UNSPECIFIED_NODE_NAME else name
        namespace = "/" if namespace == Node.UNSPECIFIED_NODE_NAMESPACE else namespace
        given_remaps = [*node.remappings, *((old, new) for old, new in own.remaps if old[:2] != "__")]
        special = dict(own.remaps)
        is_managed = False
        if isinstance(node, LifecycleNode):
            self._lifecycle.append(node)
            is_managed = evaluate_condition_expression(self.context, node.autostart)
        launched = LaunchedNode(
            package=package,
            executable=executable,
            name=special.get("__node", name),
            namespace=special.get("__ns", namespace),
            kind=kind,
            remaps=tuple(self._all_remaps(given_remaps, node.place)),
            parameters=(
                *self._parameters(node.parameters, node.place),
                *(
                    GivenValues({key: typed(Text(text), None)}, self.places.span(node.place, key))
                    for key, text in own.values
                ),
                *(GivenFile(Path(file), self.places.span(node.place, file)) for file in own.files),
            ),
            arguments=tuple(words),
            is_managed=is_managed,
            missing=self._missing(package, executable),
            place=node.place,
            span=self.places.span(node.place, executable, package, "executable"),
        )
        self._nodes.append(launched)

    def _missing(self, package: str, executable: str) -> LaunchError | None:
        try:
            if package:
                self.packages.executable(package, executable)
        except LaunchError as error:
            return error
        except LookupError as error:
            return LaunchError(str(error))
        return None

    def _components(self, nodes: Iterable[ComposableNode], place: Place | None) -> None:
        for each in nodes:
            condition = each.condition()
            if condition is not None and not condition.evaluate(self.context):
                continue
            plugin = performed(self.context, each.node_plugin)
            given = None if each.node_namespace is None else performed(self.context, each.node_namespace)
            namespace = prefix_namespace(self.context.launch_configurations.get("ros_namespace"), given)
            name = "" if each.node_name is None else performed(self.context, each.node_name)
            self._nodes.append(
                LaunchedNode(
                    package=performed(self.context, each.package),
                    executable=plugin,
                    name=name,
                    namespace=make_namespace_absolute(namespace or ""),
                    kind="component",
                    remaps=tuple(self._all_remaps(each.remappings, place)),
                    parameters=tuple(self._parameters(each.parameters, place)),
                    place=place,
                    span=self.places.span(place, name, plugin),
                )
            )

    def _all_remaps(self, own: Iterable[tuple[Any, Any]], place: Place | None) -> Iterator[Remap]:
        for old, new in self.context.launch_configurations.get("ros_remaps", ()):
            where = self._remaps.get((old, new))
            yield Remap(old, new, True, self.places.span(where, old))
        for given in own:
            old, new = (performed(self.context, each) for each in given)
            yield Remap(old, new, False, self.places.span(place, old))

    def _parameters(self, own: Iterable[Any], place: Place | None) -> Iterator[GivenValues | GivenFile]:
        for given in self.context.launch_configurations.get("global_params", ()):
            if isinstance(given, tuple):
                name, value = given
                yield GivenValues({name: value}, self.places.span(self._globals.get(name), name))
            else:
                yield GivenFile(
                    Path(given), self.places.span(self._globals.get(str(given)), Path(given).name)
                )
        for given in own:
            yield from self._evaluated(given, place)

    def _evaluated(self, given: Any, place: Place | None) -> Iterator[GivenValues | GivenFile]:
        if isinstance(given, ParameterAction):
            given = {tuple(given.name): given.value}
        if isinstance(given, ParameterFile):
            copy, path = given.evaluate(self.context), Path(performed(self.context, given.param_file))
            text = None if copy == path else copy.read_text(encoding="utf-8")
            yield GivenFile(path, self.places.span(place, str(path), path.name), text)
            return
        if not isinstance(given, Mapping):
            path = Path(performed(self.context, given))
            yield GivenFile(path, self.places.span(place, str(path), path.name))
            return
        for key, value in given.items():
            name = performed(self.context, key)
            unknown = _runs_a_command(value)
            values = {name: None} if unknown else evaluate_one(self.context, {key: value})
            assert isinstance(values, dict), "of a dict"
            for full, one in values.items():
                yield GivenValues({full: one}, self.places.span(place, full, full.rpartition(".")[2]))

    def _explained(self, error: LaunchError) -> Diagnostic:
        """An error with its place, and those of the includes that led there."""
        message = error.message
        if error.place is not None:
            message = message.partition(f":{error.place[1]}: ")[2] or message
        span = self.places.span(error.place)
        spans = (
            self.places.span(each.place) for each in reversed(self._includes) if each.place != error.place
        )
        around = tuple(Label(each, "included here") for each in dict.fromkeys(filter(None, spans)))[:4]
        primary, secondary = (Label(span), around) if span else (next(iter(around), None), around[1:])
        return Diagnostic("system-launch-file", message, primary, secondary, error.help or None)

    # What the context of a description asks its host for.

    def post(self, call: Callable[[], None]) -> None:
        """Make a call after the rest."""
        self._calls.append(_Later(call))

    def later(self, seconds: float | None, call: Callable[[], None], *, until_shutdown: bool) -> _Later:
        """Make a call after the rest, whatever the time."""
        self._calls.append(_Later(call))
        return self._calls[-1]

    def at_end(self, call: Callable[[], None]) -> None:
        """Make a call at the end of the evaluation."""
        self._ends.append(call)

    def emit(self, event: Event) -> None:
        """Ignore an event: nothing runs that could cause or answer one."""

    def handle(self, event: Event) -> None:
        """Ignore an event."""

    def completed(self, action: Action) -> None:
        """Ignore the end of an action."""

    def start(self, actions: Sequence[ExecuteLocal], process: ProcessToStart) -> None:
        """Note a program that an action of users starts."""
        self._commands.append(Command(tuple(process.command), self.places.span(actions[0].place)))


@dataclass(frozen=True, slots=True)
class _Words:
    """The parts of a command line after `--ros-args`."""

    remaps: list[tuple[str, str]]
    values: list[tuple[str, str]]
    files: list[str]


def _of_words(words: Sequence[str]) -> _Words:
    found = _Words([], [], [])
    inside = False
    for word, following in pairwise((*words, "")):
        if word == "--ros-args":
            inside = True
        elif word == "--":
            inside = False
        elif inside and word == "--params-file":
            found.files.append(following)
        elif inside and word in {"-r", "--remap", "-p", "--param"} and ":=" in following:
            name, _, value = following.partition(":=")
            (found.remaps if word in {"-r", "--remap"} else found.values).append((name, value))
    return found


def _matches(event: ChangeState, node: LifecycleNode) -> bool:
    """Whether a transition is for a node; one that asks for the name of a node that runs may be for any."""
    try:
        return event.lifecycle_node_matcher(node)
    except RuntimeError:
        return True


def _runs_a_command(value: Any) -> bool:
    """Whether a value is the output of a program, which is not run here."""
    if isinstance(value, ParameterValue):
        return _runs_a_command(value.value)
    if isinstance(value, list | tuple):
        return any(map(_runs_a_command, value))
    return isinstance(value, CommandSubstitution)
