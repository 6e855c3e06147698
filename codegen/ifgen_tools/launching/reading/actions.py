"""From elements of XML and YAML to actions."""

from __future__ import annotations

from collections.abc import Callable
from difflib import get_close_matches
from typing import Any, Final

from launch import LaunchDescription, actions
from launch.action import Action
from launch.condition import Condition
from launch.conditions import IfCondition, UnlessCondition
from launch.some_substitutions_type import SomeSubstitutionsType
from launch_ros import actions as of_ros
from launch_ros.parameter_descriptions import ParameterFile

from ifgen_tools.launching.errors import explained
from ifgen_tools.launching.reading import nodes
from ifgen_tools.launching.reading.tree import Element

Options = dict[str, Any]


def description(root: Element) -> LaunchDescription:
    """Return the description in the element `launch`. Raises LaunchError."""
    root.raw("version")
    found = LaunchDescription([_action(child) for child in root.children])
    root.finish(but="its children are actions")
    found.place = root.place
    return found


def _action(element: Element) -> Action:
    build = _KNOWN.get(element.kind)
    if build is None:
        close = get_close_matches(element.kind, _KNOWN, n=1)
        help = f"did you mean '{close[0]}'?" if close else f"it has {', '.join(sorted(_KNOWN))}"
        raise element.error(f"`ifgen launch` has no action '{element.kind}'", help)
    options: Options = {"condition": _condition(element)}
    try:
        found = build(element, options)
    except (TypeError, ValueError, RuntimeError) as error:
        raise explained(error, element.place) from None
    element.finish(but="actions" if element.kind in _CONTAINING else "")
    found.place = element.place
    return found


def _condition(element: Element) -> Condition | None:
    positive, negative = (_predicate(element, name) for name in ("if", "unless"))
    if positive is not None and negative is not None:
        raise element.error(f"'{element.kind}' has both 'if' and 'unless': one of them")
    if positive is not None:
        return IfCondition(positive)
    return None if negative is None else UnlessCondition(negative)


def _predicate(element: Element, name: str) -> Any:
    value = element.raw(name)
    return str(value).lower() if isinstance(value, bool) else element.substitutions(name)


def _inner(element: Element, *but: str) -> list[Action]:
    return [_action(child) for child in element.children if child.kind not in but]


def _arg(element: Element, options: Options) -> Action:
    choices = [_plain(choice, "value") for choice in element.inside("choice")]
    return actions.DeclareLaunchArgument(
        _plain(element, "name"),
        default_value=element.substitutions("default"),
        description=element.plain("description"),
        choices=choices or None,
        **options,
    )


def _plain(element: Element, name: str) -> str:
    element.needed(name)
    return element.plain(name) or ""


def _let(element: Element, options: Options) -> Action:
    return actions.SetLaunchConfiguration(element.needed("name"), element.needed("value"), **options)


def _unlet(element: Element, options: Options) -> Action:
    return actions.UnsetLaunchConfiguration(element.needed("name"), **options)


def _group(element: Element, options: Options) -> Action:
    for name in ("scoped", "forwarding"):
        value = element.truth(name)
        if isinstance(value, list):
            raise element.error(f"'{name}' of 'group' must be true or false")
        if value is not None:
            options[name] = value
    kept = _kept(element)
    return actions.GroupAction(_inner(element, "keep"), launch_configurations=kept, **options)


def _kept(element: Element) -> dict[SomeSubstitutionsType, SomeSubstitutionsType]:
    return {tuple(each.needed("name")): each.needed("value") for each in element.inside("keep")}


def _include(element: Element, options: Options) -> Action:
    arguments = [(each.needed("name"), each.needed("value")) for each in element.inside("arg")]
    return actions.IncludeLaunchDescription(element.needed("file"), launch_arguments=arguments, **options)


def _set_env(element: Element, options: Options) -> Action:
    return actions.SetEnvironmentVariable(element.needed("name"), element.needed("value"), **options)


def _unset_env(element: Element, options: Options) -> Action:
    return actions.UnsetEnvironmentVariable(element.needed("name"), **options)


def _append_env(element: Element, options: Options) -> Action:
    for name, value in (
        ("prepend", element.truth("prepend")),
        ("separator", element.substitutions("separator")),
    ):
        if value is not None:
            options[name] = value
    return actions.AppendEnvironmentVariable(element.needed("name"), element.needed("value"), **options)


def _log(element: Element, options: Options) -> Action:
    level = element.plain("level") or "INFO"
    if level.upper() != "INFO":
        raise element.error(f"`ifgen launch` logs with level INFO only, got '{level}'")
    return actions.LogInfo(msg=element.needed("message"), **options)


def _timer(element: Element, options: Options) -> Action:
    number = element.raw("period")
    period: Any = str(number) if isinstance(number, int | float) else element.needed("period")
    return actions.TimerAction(period=period, actions=_inner(element), **options)


def _shutdown(element: Element, options: Options) -> Action:
    reason = element.substitutions("reason")
    return actions.Shutdown(**options) if reason is None else actions.Shutdown(reason=reason, **options)


def _reset(element: Element, options: Options) -> Action:
    kept = _kept(element)
    return actions.ResetLaunchConfigurations(kept, **options)


def _namespace(element: Element, options: Options) -> Action:
    return of_ros.PushRosNamespace(element.needed("namespace"), **options)


def _set_remap(element: Element, options: Options) -> Action:
    return of_ros.SetRemap(element.needed("from"), element.needed("to"), **options)


def _set_parameter(element: Element, options: Options) -> Action:
    return of_ros.SetParameter(element.needed("name"), nodes.value_of(element), **options)


def _set_parameters_from_file(element: Element, options: Options) -> Action:
    return of_ros.SetParametersFromFile(ParameterFile(element.needed("filename")), **options)


def _set_use_sim_time(element: Element, options: Options) -> Action:
    value = element.truth("value")
    if value is None:
        raise element.error("'set_use_sim_time' needs the attribute 'value'")
    return of_ros.SetUseSimTime(value, **options)


def _set_log_dir(element: Element, options: Options) -> Action:
    return of_ros.SetROSLogDir(element.needed("new_log_dir"), **options)


def _transition(element: Element, options: Options) -> Action:
    names = [each.needed("name") for each in element.inside("lifecycle_node")]
    ids = [each.needed("id") for each in element.inside("transition")]
    return of_ros.LifecycleTransition(lifecycle_node_names=names, transition_ids=ids, **options)


_CONTAINING: Final = {"group", "timer"}
_KNOWN: Final[dict[str, Callable[[Element, Options], Action]]] = {
    "append_env": _append_env,
    "arg": _arg,
    "executable": nodes.executable,
    "group": _group,
    "include": _include,
    "let": _let,
    "lifecycle_node": nodes.lifecycle_node,
    "lifecycle_transition": _transition,
    "log": _log,
    "node": nodes.node,
    "push-ros-namespace": _namespace,
    "push_ros_namespace": _namespace,
    "reset": _reset,
    "set_env": _set_env,
    "set_parameter": _set_parameter,
    "set_parameters_from_file": _set_parameters_from_file,
    "set_remap": _set_remap,
    "set_ros_log_dir": _set_log_dir,
    "set_use_sim_time": _set_use_sim_time,
    "shutdown": _shutdown,
    "timer": _timer,
    "unlet": _unlet,
    "unset_env": _unset_env,
}
"""The actions by their names in XML and YAML."""
