"""Elements of processes and nodes, with their parameters."""

from __future__ import annotations

import shlex
from typing import Any, Final

from launch.action import Action
from launch.actions import ExecuteProcess, Shutdown
from launch.substitution import Substitution
from launch.substitutions import TextSubstitution
from launch_ros.actions import LifecycleNode, Node
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue, Text

from ifgen_tools.launching.errors import explained
from ifgen_tools.launching.reading.texts import parse
from ifgen_tools.launching.reading.tree import Element

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


def executable(element: Element, options: Options) -> Action:
    """Return the action of an `executable`. Raises LaunchError."""
    element.needed("cmd")
    return ExecuteProcess(
        cmd=_words(element, "cmd"), name=element.substitutions("name"), **_process(element, options)
    )


def node(element: Element, options: Options) -> Action:
    """Return the action of a `node`. Raises LaunchError."""
    return Node(**_node(element, options))


def lifecycle_node(element: Element, options: Options) -> Action:
    """Return the action of a `lifecycle_node`. Raises LaunchError."""
    given = _node(element, options)
    autostart = element.truth("autostart")
    if autostart is not None:
        given["autostart"] = autostart
    element.needed("name")
    return LifecycleNode(**{"namespace": "", **given})


def _node(element: Element, options: Options) -> Options:
    given = _process(element, options)
    for name, attribute in (
        ("package", "pkg"),
        ("name", "name"),
        ("namespace", "namespace"),
        ("exec_name", "exec_name"),
    ):
        if (value := element.substitutions(attribute)) is not None:
            given[name] = value
    given["executable"] = element.needed("exec")
    given["arguments"] = _words(element, "args")
    given["ros_arguments"] = _words(element, "ros_args")
    given["remappings"] = []
    for each in element.inside("remap"):
        given["remappings"].append((each.needed("from"), each.needed("to")))
        each.finish()
    given["parameters"] = [_parameter(each) for each in element.inside("param")]
    return given


def _process(element: Element, options: Options) -> Options:
    for option, attribute in (("cwd", "cwd"), ("prefix", "launch-prefix"), ("output", "output")):
        if (text := element.substitutions(attribute)) is not None:
            options[option] = text
    for name in ("sigterm_timeout", "sigkill_timeout"):
        value = element.raw(name)
        if value is not None:
            options[name] = str(value) if isinstance(value, int | float) else element.substitutions(name)
    for name in ("respawn", "shell", "emulate_tty", "log_cmd"):
        if (truth := element.truth(name)) is not None:
            options[name] = truth
    delay, retries = element.number("respawn_delay"), element.number("respawn_max_retries")
    if delay is not None and delay < 0:
        raise element.error("'respawn_delay' cannot be negative")
    options["respawn_delay"] = delay
    options["respawn_max_retries"] = -1 if retries is None else int(retries)
    options["additional_env"] = {
        tuple(each.needed("name")): each.needed("value") for each in element.inside("env")
    }
    if (on_exit := element.plain("on_exit")) is not None:
        if on_exit != "shutdown":
            raise element.error(f"'on_exit' must be 'shutdown', got '{on_exit}'")
        options["on_exit"] = Shutdown(reason=f"a process of this {element.kind} has ended")
    return options


def _words(element: Element, name: str) -> list[list[Substitution]]:
    """The words of a command line: spaces outside of substitutions and quotes separate them."""
    words: list[list[Substitution]] = []
    is_open = False
    for part in element.substitutions(name) or ():
        if not isinstance(part, TextSubstitution):
            if not is_open:
                words.append([])
            words[-1].append(part)
            is_open = True
            continue
        try:
            texts = shlex.split(part.text)
        except ValueError as error:
            raise element.error(f"'{name}' of '{element.kind}': {str(error).lower()}") from None
        for number, text in enumerate(texts):
            if number or not is_open or part.text[0].isspace():
                words.append([])
            words[-1].append(TextSubstitution(text=text))
        is_open = bool(part.text) and not part.text[-1].isspace()
    return words


def _parameter(element: Element) -> Any:
    file = element.substitutions("from")
    if file is not None:
        if "name" in element.attributes:
            raise element.error("'param' has both 'from' and 'name': one of them")
        truth = element.truth("allow_substs")
        found = ParameterFile(file, allow_substs=False if truth is None else truth)
        element.finish()
        return found
    if "name" not in element.attributes:
        raise element.error("'param' needs the attribute 'name', or 'from' with a file")
    return _named(element)


def _named(element: Element) -> dict[Any, Any]:
    name = tuple(element.needed("name"))
    inside = list(element.inside("param"))
    if inside and "value" in element.attributes:
        raise element.error("'param' has both a value and parameters inside: one of them")
    nested: dict[Any, Any] = {}
    for each in inside:
        nested |= _named(each)
    value = nested if inside else value_of(element)
    element.finish()
    return {name: value}


def value_of(element: Element) -> Any:
    """Return the attribute `value` with its `type`, as the value of a parameter. Raises LaunchError."""
    identifier, separator = element.plain("type"), element.plain("value-sep")
    value = element.raw("value")
    if value is None:
        raise element.error(f"'{element.kind}' needs the attribute 'value'")
    if identifier is not None and identifier not in _TYPES:
        raise element.error(f"there is no type '{identifier}'", f"choose from {', '.join(_TYPES)}")
    wanted = _TYPES.get(identifier or "")
    if separator is not None and isinstance(value, str):
        value = [_part(element, each) for each in value.split(separator)]
    elif isinstance(value, list):
        value = [_part(element, each) for each in value]
    else:
        value = _part(element, value)
    if wanted is not None or element.values_are_texts:
        return _checked(element, ParameterValue(value, value_type=wanted))
    return value


def _part(element: Element, value: Any) -> Any:
    if not isinstance(value, str):
        return value
    parts = parse(value, element.attributes["value"][1])
    if all(isinstance(each, TextSubstitution) for each in parts):
        text = "".join(each.text for each in parts if isinstance(each, TextSubstitution))
        return Text(text) if element.values_are_texts else text
    return parts


def _checked(element: Element, value: ParameterValue) -> ParameterValue:
    """The value, whose type is compared now if it has no substitutions."""
    items = value.value if isinstance(value.value, list) else [value.value]
    if not any(isinstance(each, Substitution | list) for each in items):
        try:
            value.evaluate(None)  # type: ignore[arg-type]  # nothing in it needs a context
        except (TypeError, ValueError) as error:
            raise explained(error, element.place) from None
    return value
