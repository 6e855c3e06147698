"""The attributes of launch's own actions in XML and YAML."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

from launch import actions
from launch.action import Action
from launch.frontend.entity import Entity
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.substitutions import TextSubstitution

if TYPE_CHECKING:
    from launch.frontend.parser import Parser

Options = dict[str, Any]


def inner(entity: Entity, parser: Parser, *but: str) -> list[Action]:
    """Return the actions inside an element, except those of some kinds. Raises LaunchError."""
    return [parser.parse_action(child) for child in entity.children if child.kind not in but]


def needs(**attributes: str) -> Callable[[Entity, Parser], Options]:
    """Return a reader of texts that must be there: arguments of the action, by names of attributes."""
    return lambda entity, parser: {
        argument: entity.needed(attribute) for argument, attribute in attributes.items()
    }


def _arg(entity: Entity, parser: Parser) -> Options:
    choices = [_plain(choice, "value") for choice in entity.inside("choice")]
    return {
        "name": _plain(entity, "name"),
        "default_value": entity.substitutions("default"),
        "description": entity.plain("description"),
        "choices": choices or None,
    }


def _plain(entity: Entity, name: str) -> str:
    entity.needed(name)
    return entity.plain(name) or ""


def _group(entity: Entity, parser: Parser) -> Options:
    options: Options = {}
    for name in ("scoped", "forwarding"):
        value = entity.truth(name)
        if isinstance(value, list):
            raise entity.error(f"'{name}' of 'group' must be true or false")
        if value is not None:
            options[name] = value
    options["launch_configurations"] = _kept(entity)
    return {**options, "actions": inner(entity, parser, "keep")}


def _kept(entity: Entity) -> dict[SomeSubstitutionsType, SomeSubstitutionsType]:
    return {tuple(each.needed("name")): each.needed("value") for each in entity.inside("keep")}


def _include(entity: Entity, parser: Parser) -> Options:
    arguments = [
        (each.needed("name"), each.needed("value")) for kind in ("arg", "let") for each in entity.inside(kind)
    ]
    return {"launch_description_source": entity.needed("file"), "launch_arguments": arguments}


def _append_env(entity: Entity, parser: Parser) -> Options:
    options: Options = {"prepend": entity.truth("prepend"), "separator": entity.substitutions("separator")}
    given = {name: value for name, value in options.items() if value is not None}
    return {"name": entity.needed("name"), "value": entity.needed("value"), **given}


def _log(entity: Entity, parser: Parser) -> Options:
    level = entity.plain("level") or "INFO"
    if level.upper() != "INFO":
        raise entity.error(f"`ifgen launch` logs with level INFO only, got '{level}'")
    return {"msg": entity.needed("message")}


def timer(entity: Entity, parser: Parser) -> Options:
    """Return the arguments of a timer. Raises LaunchError."""
    number = entity.raw("period")
    period: Any = str(number) if isinstance(number, int | float) else entity.needed("period")
    return {"period": period, "actions": inner(entity, parser)}


def _shutdown(entity: Entity, parser: Parser) -> Options:
    reason = entity.substitutions("reason")
    return {} if reason is None else {"reason": reason}


def _executable(entity: Entity, parser: Parser) -> Options:
    entity.needed("cmd")
    return {"cmd": words(entity, "cmd"), "name": entity.substitutions("name"), **process(entity)}


def process(entity: Entity) -> Options:
    """Return the arguments that all processes have. Raises LaunchError."""
    options: Options = {}
    for option, attribute in (("cwd", "cwd"), ("prefix", "launch-prefix"), ("output", "output")):
        if (text := entity.substitutions(attribute)) is not None:
            options[option] = text
    for name in ("sigterm_timeout", "sigkill_timeout"):
        value = entity.raw(name)
        if value is not None:
            options[name] = str(value) if isinstance(value, int | float) else entity.substitutions(name)
    for name in ("respawn", "shell", "emulate_tty", "log_cmd"):
        if (truth := entity.truth(name)) is not None:
            options[name] = truth
    delay, retries = entity.number("respawn_delay"), entity.number("respawn_max_retries")
    if delay is not None and delay < 0:
        raise entity.error("'respawn_delay' cannot be negative")
    options["respawn_delay"] = delay
    options["respawn_max_retries"] = -1 if retries is None else int(retries)
    options["additional_env"] = {
        tuple(each.needed("name")): each.needed("value") for each in entity.inside("env")
    }
    if (on_exit := entity.plain("on_exit")) is not None:
        if on_exit != "shutdown":
            raise entity.error(f"'on_exit' must be 'shutdown', got '{on_exit}'")
        options["on_exit"] = actions.Shutdown(reason=f"a process of this {entity.kind} has ended")
    return options


def words(entity: Entity, name: str) -> list[list[Substitution]]:
    """Return the words of a command line: spaces outside of substitutions and quotes separate them."""
    found: list[list[Substitution]] = []
    is_open = False
    for part in entity.substitutions(name) or ():
        if not isinstance(part, TextSubstitution):
            if not is_open:
                found.append([])
            found[-1].append(part)
            is_open = True
            continue
        try:
            texts = shlex.split(part.text)
        except ValueError as error:
            raise entity.error(f"'{name}' of '{entity.kind}': {str(error).lower()}") from None
        for number, text in enumerate(texts):
            if number or not is_open or part.text[0].isspace():
                found.append([])
            found[-1].append(TextSubstitution(text=text))
        is_open = bool(part.text) and not part.text[-1].isspace()
    return found


KINDS: Final[Mapping[str, type[Action]]] = {
    "append_env": actions.AppendEnvironmentVariable,
    "arg": actions.DeclareLaunchArgument,
    "executable": actions.ExecuteProcess,
    "group": actions.GroupAction,
    "include": actions.IncludeLaunchDescription,
    "let": actions.SetLaunchConfiguration,
    "log": actions.LogInfo,
    "reset": actions.ResetLaunchConfigurations,
    "set_env": actions.SetEnvironmentVariable,
    "shutdown": actions.Shutdown,
    "timer": actions.TimerAction,
    "unlet": actions.UnsetLaunchConfiguration,
    "unset_env": actions.UnsetEnvironmentVariable,
}
READERS: Final[Mapping[type[Action], Callable[[Entity, Any], Options]]] = {
    actions.AppendEnvironmentVariable: _append_env,
    actions.DeclareLaunchArgument: _arg,
    actions.ExecuteProcess: _executable,
    actions.GroupAction: _group,
    actions.IncludeLaunchDescription: _include,
    actions.LogInfo: _log,
    actions.ResetLaunchConfigurations: lambda entity, parser: {"launch_configurations": _kept(entity)},
    actions.SetEnvironmentVariable: needs(name="name", value="value"),
    actions.SetLaunchConfiguration: needs(name="name", value="value"),
    actions.Shutdown: _shutdown,
    actions.TimerAction: timer,
    actions.UnsetEnvironmentVariable: needs(name="name"),
    actions.UnsetLaunchConfiguration: needs(name="name"),
}
CONTAINING: Final[set[type[Action]]] = {actions.GroupAction, actions.TimerAction}
