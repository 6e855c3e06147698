# Values that users write are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""The attributes of actions about nodes in XML and YAML, and the substitutions about packages."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from launch._errors import explained
from launch.action import Action
from launch.frontend import _elements as of_launch
from launch.frontend.entity import Entity
from launch.frontend.parse_substitution import add_substitutions, parse
from launch.frontend.parser import Parser
from launch.substitution import Substitution
from launch.substitutions import TextSubstitution

from launch_ros import actions, substitutions
from launch_ros.descriptions import ComposableNode
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue, Text

Options = dict[str, Any]

_TYPES: Final[dict[str, Any]] = {
    "bool": bool,
    "float": float,
    "int": int,
    "str": str,
    "list_of_bools": list[bool],
    "list_of_floats": list[float],
    "list_of_ints": list[int],
    "list_of_strs": list[str],
}


def _node(entity: Entity, parser: Parser) -> Options:
    given = of_launch.process(entity)
    for name, attribute in (
        ("package", "pkg"),
        ("name", "name"),
        ("namespace", "namespace"),
        ("exec_name", "exec_name"),
    ):
        if (value := entity.substitutions(attribute)) is not None:
            given[name] = value
    given["executable"] = entity.needed("exec")
    given["arguments"] = of_launch.words(entity, "args")
    given["ros_arguments"] = of_launch.words(entity, "ros_args")
    return {**given, **_remappings_and_parameters(entity)}


def _remappings_and_parameters(entity: Entity) -> Options:
    remappings: list[Any] = []
    for each in entity.inside("remap"):
        remappings.append((each.needed("from"), each.needed("to")))
        each.finish()
    return {"remappings": remappings, "parameters": [_parameter(each) for each in entity.inside("param")]}


def _lifecycle_node(entity: Entity, parser: Parser) -> Options:
    given = _node(entity, parser)
    autostart = entity.truth("autostart")
    if autostart is not None:
        given["autostart"] = autostart
    entity.needed("name")
    return {"namespace": "", **given}


def _container(entity: Entity, parser: Parser) -> Options:
    entity.needed("name")
    nodes = [_composable_node(each) for each in entity.inside("composable_node")]
    return {"namespace": "", **_node(entity, parser), "composable_node_descriptions": nodes}


def _composable_node(entity: Entity) -> ComposableNode:
    if any(entity.raw(name) is not None for name in ("if", "unless")):
        condition: Any = Parser().arguments(Action, entity)["condition"]
    else:
        condition = None
    extra = [_named(each) for each in entity.inside("extra_arg")]
    found = ComposableNode(
        package=entity.needed("pkg"),
        plugin=entity.needed("plugin"),
        name=entity.substitutions("name"),
        namespace=entity.substitutions("namespace"),
        extra_arguments=extra or None,
        condition=condition,
        **_remappings_and_parameters(entity),
    )
    entity.finish()
    return found


def _load(entity: Entity, parser: Parser) -> Options:
    nodes = [_composable_node(each) for each in entity.inside("composable_node")]
    return {"target_container": entity.needed("target"), "composable_node_descriptions": nodes}


def _set_use_sim_time(entity: Entity, parser: Parser) -> Options:
    value = entity.truth("value")
    if value is None:
        raise entity.error("'set_use_sim_time' needs the attribute 'value'")
    return {"value": value}


def _transition(entity: Entity, parser: Parser) -> Options:
    names = [each.needed("name") for each in entity.inside("lifecycle_node")]
    ids = [each.needed("id") for each in entity.inside("transition")]
    return {"lifecycle_node_names": names, "transition_ids": ids}


def _parameter(entity: Entity) -> Any:
    file = entity.substitutions("from")
    if file is not None:
        if "name" in entity.attributes:
            raise entity.error("'param' has both 'from' and 'name': one of them")
        truth = entity.truth("allow_substs")
        found = ParameterFile(file, allow_substs=False if truth is None else truth)
        entity.finish()
        return found
    if "name" not in entity.attributes:
        raise entity.error("'param' needs the attribute 'name', or 'from' with a file")
    return _named(entity)


def _named(entity: Entity) -> dict[Any, Any]:
    name = tuple(entity.needed("name"))
    inside = list(entity.inside("param"))
    if inside and "value" in entity.attributes:
        raise entity.error("'param' has both a value and parameters inside: one of them")
    nested: dict[Any, Any] = {}
    for each in inside:
        nested |= _named(each)
    value = nested if inside else value_of(entity)
    entity.finish()
    return {name: value}


def value_of(entity: Entity) -> Any:
    """Return the attribute `value` with its `type`, as the value of a parameter. Raises LaunchError."""
    identifier, separator = entity.plain("type"), entity.plain("value-sep")
    value = entity.raw("value")
    if value is None:
        raise entity.error(f"'{entity.kind}' needs the attribute 'value'")
    if identifier is not None and identifier not in _TYPES:
        raise entity.error(f"there is no type '{identifier}'", f"choose from {', '.join(_TYPES)}")
    wanted = _TYPES.get(identifier or "")
    if separator is not None and isinstance(value, str):
        value = [_part(entity, each) for each in value.split(separator)]
    elif isinstance(value, list):
        value = [_part(entity, each) for each in value]
    else:
        value = _part(entity, value)
    if wanted is not None or entity.values_are_texts:
        return _checked(entity, ParameterValue(value, value_type=wanted))
    return value


def _part(entity: Entity, value: Any) -> Any:
    if not isinstance(value, str):
        return value
    parts = parse(value, entity.attributes["value"][1])
    if all(isinstance(each, TextSubstitution) for each in parts):
        text = "".join(each.text for each in parts if isinstance(each, TextSubstitution))
        return Text(text) if entity.values_are_texts else text
    return parts


def _checked(entity: Entity, value: ParameterValue) -> ParameterValue:
    """The value, whose type is compared now if it has no substitutions."""
    items = value.value if isinstance(value.value, list) else [value.value]
    if not any(isinstance(each, Substitution | list) for each in items):
        try:
            value.evaluate(None)  # type: ignore[arg-type]  # nothing in it needs a context
        except (TypeError, ValueError) as error:
            raise explained(error, entity.place) from None
    return value


_KINDS: Final[dict[str, type[Action]]] = {
    "lifecycle_node": actions.LifecycleNode,
    "lifecycle_transition": actions.LifecycleTransition,
    "load_composable_node": actions.LoadComposableNodes,
    "node": actions.Node,
    "node_container": actions.ComposableNodeContainer,
    "push-ros-namespace": actions.PushRosNamespace,
    "push_ros_namespace": actions.PushRosNamespace,
    "ros_timer": actions.RosTimer,
    "set_parameter": actions.SetParameter,
    "set_parameters_from_file": actions.SetParametersFromFile,
    "set_remap": actions.SetRemap,
    "set_ros_log_dir": actions.SetROSLogDir,
    "set_use_sim_time": actions.SetUseSimTime,
}
_READERS: Final[dict[type[Action], Callable[[Entity, Parser], Options]]] = {
    actions.ComposableNodeContainer: _container,
    actions.LifecycleNode: _lifecycle_node,
    actions.LifecycleTransition: _transition,
    actions.LoadComposableNodes: _load,
    actions.Node: _node,
    actions.PushRosNamespace: of_launch.needs(namespace="namespace"),
    actions.RosTimer: of_launch.timer,
    actions.SetParameter: lambda entity, parser: {"name": entity.needed("name"), "value": value_of(entity)},
    actions.SetParametersFromFile: lambda entity, parser: {
        "filename": ParameterFile(entity.needed("filename"))
    },
    actions.SetRemap: of_launch.needs(src="from", dst="to"),
    actions.SetROSLogDir: of_launch.needs(new_log_dir="new_log_dir"),
    actions.SetUseSimTime: _set_use_sim_time,
}


def _in_package(executable: Any, package: Any) -> Substitution:
    return substitutions.ExecutableInPackage(executable=executable, package=package)


def _parameter_value(name: Any, default: Any = None) -> Substitution:
    return substitutions.Parameter(name, default=default)


def register() -> None:
    """Add them to what launch files in XML and YAML can name."""
    Parser.add(_KINDS, _READERS, set())
    add_substitutions(
        {
            "exec-in-pkg": (_in_package, 2, 2),
            "find-pkg-prefix": (substitutions.FindPackagePrefix, 1, 1),
            "find-pkg-share": (substitutions.FindPackageShare, 1, 1),
            "param": (_parameter_value, 1, 2),
        }
    )
