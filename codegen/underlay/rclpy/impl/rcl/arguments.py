"""`--ros-args`: remap rules, parameters, log levels and switches, of a process (context) or of one node.

Parameter overrides, also those of files, are kept by node pattern (`/**`, `/ns/*`, `/n`), as
rcl_yaml_param_parser does. Patterns keep the order in which they first appear over all sources; later
sources overwrite values inside a pattern. A node takes every pattern that matches it in that order, so a
later pattern wins over an earlier one however specific they are.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final

from ifgen_runtime.parameters.parameter_scalars import ParameterVariant, Value, read_scalar

from .handle import RCLError, RCLInvalidROSArgsError, UnknownROSArgsError
from .logging import (
    RCUTILS_LOG_SEVERITY,
    rclpy_logging_rcutils_log,
    rclpy_logging_severity_level_from_string,
)
from .names import rclpy_get_validation_error_for_namespace, rclpy_get_validation_error_for_node_name
from .rules import Lexeme, Lexer, RemapRule, RuleError, parse_remap_rule

_WILDCARDS: Final = ("*", "**")

Entry = dict[str, ParameterVariant]


class ParameterOverrides:
    """Parameters by node pattern as it was written (`n` is not `/n`), in order of first appearance."""

    def __init__(self) -> None:
        self._entries: dict[str, Entry] = {}
        self._by_hand: set[tuple[str, str]] = set()  # pattern and name of each `-p`
        self._used: dict[str, set[str]] = {}  # the names that nodes have declared, by pattern
        self._nodes: set[str] = set()

    def __bool__(self) -> bool:
        return bool(self._entries)

    def entry(self, pattern: str) -> Entry:
        """The parameters of a node pattern, created when missing. Raises RuleError for a bad pattern."""
        if pattern not in self._entries:
            _check_pattern(pattern)
        return self._entries.setdefault(pattern, {})

    def matching(self, full_name: str) -> Iterator[tuple[str, Value]]:
        """(name, value) of every override for the node `full_name`; later ones win."""
        for pattern, entry in self._entries.items():
            if _matches(pattern, full_name):
                for name, variant in entry.items():
                    yield name, variant.value()

    def override(self, pattern: str, name: str) -> ParameterVariant:
        """The parameter that `-p` names, created when missing. Raises RuleError for a bad pattern."""
        self._by_hand.add((pattern, name))
        return self.entry(pattern).setdefault(name, ParameterVariant())

    def use(self, full_name: str, names: Iterable[str] | None) -> None:
        """Note that a node is there, and has declared parameters; None stands for all of them."""
        self._nodes.add(full_name)
        for pattern, entry in self._entries.items():
            if _matches(pattern, full_name):
                self._used.setdefault(pattern, set()).update(entry if names is None else names)

    def unused(self) -> Iterator[str]:
        """A sentence for each override that no node took, if it was given for one node or with `-p`.

        A file for several nodes is as it should be if one of them is here.
        """
        from difflib import get_close_matches  # only the end of a program needs it

        exact = [pattern for pattern in self._entries if "*" not in pattern]
        if self._nodes and exact and not any(pattern in self._used for pattern in exact):
            nodes = ", ".join(sorted(self._nodes))
            yield f"Parameters for {', '.join(exact)} were given, but there was no such node: only {nodes}"
        for pattern, used in self._used.items():
            for name in self._entries[pattern]:
                is_meant = pattern in exact or (pattern, name) in self._by_hand
                if is_meant and name not in used:
                    near = get_close_matches(name, used, n=1, cutoff=0.5)
                    advice = f": did you mean '{near[0]}'?" if near else ""
                    yield f"The parameter '{name}' was given, but no node declared it{advice}"


def _check_pattern(pattern: str) -> None:
    """Raise RuleError unless the pattern is a node's full name, in which wildcards may stand for tokens."""
    namespace, _, name = _absolute(pattern).rpartition("/")
    if "//" in f"{namespace}/":
        raise RuleError(f"{namespace}/ contains repeated forward slash")
    for token in namespace.split("/")[1:]:
        if token not in _WILDCARDS and (error := rclpy_get_validation_error_for_namespace(f"/{token}")):
            raise RuleError(error[0])
    if name not in _WILDCARDS and (error := rclpy_get_validation_error_for_node_name(name)):
        raise RuleError(error[0])


def _absolute(pattern: str) -> str:
    return pattern if pattern.startswith("/") else f"/{pattern}"


def _matches(pattern: str, full_name: str) -> bool:
    """Whether `*` as one token and `**` as any number of tokens make the pattern the name."""
    pattern = _absolute(pattern)
    if "*" not in pattern:
        return pattern == full_name
    # A run of `**` is one `**`: without this, nested quantifiers would explode.
    expression = re.escape(re.sub(r"(?:/\*\*)+", "/**", pattern))
    expression = expression.replace(r"/\*\*", r"(?:/\w+)*").replace(r"/\*", r"/\w+")
    return re.fullmatch(expression, full_name) is not None


def parse_override_rule(rule: str, overrides: ParameterOverrides) -> None:
    """Read `[node:]name:=yaml` of `-p` into `overrides`; raises RuleError."""
    lexer = Lexer(rule)
    node = lexer.node_prefix()
    name = _parameter_name(lexer)
    text = lexer.rest()
    if not text:
        raise RuleError("error not set")  # the C layer says no more than this
    variant = overrides.override("/**" if node is None else node, name)
    # Most values are a plain word or number: they need no YAML parser, whose import costs milliseconds.
    if re.fullmatch(r"[\w.+/]+", text, re.ASCII):
        variant.set_scalar(read_scalar(text))
        return
    from ifgen_runtime.parameters import parameter_yaml  # with a YAML parser

    try:
        parameter_yaml.read_value(text, variant)
    except parameter_yaml.ParameterYamlError as error:
        raise RuleError(str(error)) from None


def _parameter_name(lexer: Lexer) -> str:
    start = lexer.position
    while True:
        lexer.refuse_wildcards()
        while lexer.peek() in (Lexeme.TOKEN, Lexeme.SLASH):
            lexer.accept()
        if lexer.peek() is Lexeme.SEPARATOR:
            break
        lexer.expect(Lexeme.DOT)
    name = lexer.text[start : lexer.position]
    lexer.accept()
    return name


def read_file(path: str, overrides: ParameterOverrides) -> None:
    """Read a parameter file into `overrides`; raises RuleError."""
    from ifgen_runtime.parameters import parameter_yaml  # with a YAML parser

    try:
        parameter_yaml.read_file(path, overrides.entry)
    except parameter_yaml.ParameterYamlError as error:
        raise RuleError(str(error)) from None


@dataclass(slots=True)
class Arguments:
    """The ROS arguments of a command line."""

    remap_rules: list[RemapRule] = field(default_factory=list)
    parameters: ParameterOverrides = field(default_factory=ParameterOverrides)
    default_log_level: int | None = None
    log_levels: dict[str, int] = field(default_factory=dict)
    log_file_prefix: str | None = None
    log_config_file: str | None = None
    enclave: str = "/"
    rosout_logs: bool = True
    stdout_logs: bool = True
    external_lib_logs: bool = True
    unparsed: list[str] = field(default_factory=list)
    """The user's own arguments, in order."""
    unknown: list[str] = field(default_factory=list)
    """Arguments after `--ros-args` that ROS does not know."""


def parse_arguments(args: Sequence[str], *, warn: Callable[[str], None] | None = None) -> Arguments:
    """Read a command line; the name of the program may lead it.

    Raises RuleError with the text of rcl; UnknownROSArgsError for unknown flags after `--ros-args`; TypeError
    for arguments that are not strings; UnicodeEncodeError for those without UTF-8 (PEP 383). `warn` receives
    rcl's warnings.
    """
    texts = list(args)
    if not all(isinstance(text, str) for text in texts):
        raise TypeError("bad argument type for built-in operation")
    for text in texts:
        text.encode()
    parsed = _Parser(texts, warn or _warn).parse()
    if parsed.unknown:
        raise UnknownROSArgsError(repr(parsed.unknown))
    return parsed


def parse_context_arguments(args: Sequence[str]) -> Arguments:
    """The arguments of a process; raises RCLError `failed to initialize rcl: ...`."""
    try:
        arguments = parse_arguments(args)
    except RuleError as error:
        _log("ERROR", "Failed to parse global arguments")
        raise RCLError(f"failed to initialize rcl: {error}") from None
    if arguments.log_config_file is not None:
        raise RCLError(
            "failed to initialize logging: "
            "spdlog logging backend doesn't currently support external configuration"
        )
    if fault := rclpy_get_validation_error_for_namespace(arguments.enclave):
        reason = fault[0].replace("namespace", "context name", 1)
        raise RCLError(
            f"failed to initialize rcl: Enclave name is not valid: '{reason}'. Invalid index: {fault[1]}"
        )
    return arguments


def parse_node_arguments(args: Sequence[str]) -> Arguments:
    """The arguments of one node; raises RCLInvalidROSArgsError `Failed to parse ROS arguments: ...`."""
    try:
        return parse_arguments(args)
    except RuleError as error:
        raise RCLInvalidROSArgsError(f"Failed to parse ROS arguments: {error}") from None


def rclpy_remove_ros_args(args: Iterable[str] | None) -> list[str]:
    """The arguments that are left for the program itself; raises as `parse_node_arguments` does."""
    return [] if args is None else parse_node_arguments(list(args)).unparsed


def warn_of_unused(arguments: Arguments) -> None:
    """Name on stderr the parameters that no node took."""
    for sentence in arguments.parameters.unused():
        _warn(sentence)


def _warn(text: str) -> None:
    _log("WARN", text)


def _log(severity: str, text: str) -> None:
    level = RCUTILS_LOG_SEVERITY[f"RCUTILS_LOG_SEVERITY_{severity}"]
    rclpy_logging_rcutils_log(level, "rcl", text, "", "", 0)


class _Parser:
    """One pass over the arguments; `--ros-args` starts the ROS arguments, `--` ends them."""

    def __init__(self, args: list[str], warn: Callable[[str], None]) -> None:
        self._args = args
        self._warn = warn
        self._result = Arguments()

    def parse(self) -> Arguments:
        in_ros_args = False
        position = 0
        while position < len(self._args):
            arg = self._args[position]
            position += 1
            if not in_ros_args:
                if arg == "--ros-args":
                    in_ros_args = True
                elif not self._take_old_style(arg):
                    self._result.unparsed.append(arg)
            elif arg == "--":
                in_ros_args = False
            elif arg in _FLAGS_WITH_VALUE:
                self._take_flag(arg, self._args[position] if position < len(self._args) else None)
                position += 1
            elif arg in _SWITCHES:
                setattr(self._result, *_SWITCHES[arg])
            elif arg != "--ros-args":
                self._result.unknown.append(arg)
        return self._result

    def _take_flag(self, flag: str, value: str | None) -> None:
        handler, failure, missing = _FLAGS_WITH_VALUE[flag]
        if value is None:
            raise RuleError(f"Couldn't parse trailing {missing.format(flag)}")
        try:
            handler(self._result, value, self._warn)
        except RuleError as error:
            raise RuleError(f"Couldn't parse {failure}: '{flag} {value}'. Error: {error}") from None

    def _take_old_style(self, arg: str) -> bool:
        """Remap rules without `--ros-args`, as in ROS 1 and early ROS 2."""
        if ":=" not in arg:
            return False
        try:
            _take_remap(self._result, arg, self._warn)
        except RuleError:
            return False
        self._warn(
            f"Found remap rule '{arg}'. This syntax is deprecated. Use '--ros-args --remap {arg}' instead."
        )
        return True


Warn = Callable[[str], None]


def _take_remap(result: Arguments, value: str, warn: Warn) -> None:
    result.remap_rules.append(parse_remap_rule(value, warn))


def _take_parameter(result: Arguments, value: str, _: Warn) -> None:
    parse_override_rule(value, result.parameters)


def _take_parameter_file(result: Arguments, value: str, _: Warn) -> None:
    read_file(value, result.parameters)


def _severity(text: str) -> int:
    try:
        return rclpy_logging_severity_level_from_string(text)
    except RuntimeError:
        raise RuleError("Argument does not use a valid severity level") from None


def _take_log_level(result: Arguments, value: str, _: Warn) -> None:
    name, separator, level = value.partition(":=")
    if not separator:
        result.default_log_level = _severity(value)
        return
    if not name:
        raise RuleError("Argument has an invalid logger item that name is empty")
    lexer = Lexer(value)
    lexer.position = len(name) + len(separator)
    level = lexer.expect(Lexeme.TOKEN)
    lexer.expect(Lexeme.END)
    result.log_levels[name] = _severity(level)


def _take_log_file_prefix(result: Arguments, value: str, _: Warn) -> None:
    result.log_file_prefix = value


def _take_log_config(result: Arguments, value: str, _: Warn) -> None:
    result.log_config_file = value


def _take_enclave(result: Arguments, value: str, _: Warn) -> None:
    result.enclave = value


Handler = Callable[[Arguments, str, Warn], None]
_REMAP = (_take_remap, "remap rule", "{} flag. No remap rule found.")
_PARAMETER = (_take_parameter, "parameter override rule", "{} flag. No parameter override rule found.")
_ENCLAVE = (_take_enclave, "enclave path", "{} flag. No enclave path provided.")
# flag -> (handler, what could not be parsed, the sentence when the value is missing)
_FLAGS_WITH_VALUE: dict[str, tuple[Handler, str, str]] = {
    "-r": _REMAP,
    "--remap": _REMAP,
    "-p": _PARAMETER,
    "--param": _PARAMETER,
    "--params-file": (_take_parameter_file, "params file", "{} flag. No file path provided."),
    "--log-level": (_take_log_level, "log level", "log level flag: '{}'. No log level provided."),
    "--log-config-file": (_take_log_config, "log config file", "{} flag. No file path provided."),
    "--log-file-name": (_take_log_file_prefix, "log file name", "{} flag. No string prefix provided."),
    "-e": _ENCLAVE,
    "--enclave": _ENCLAVE,
}
_SWITCHES = {
    f"--{verb}-{what}-logs": (f"{what.replace('-', '_')}_logs", verb == "enable")
    for verb in ("enable", "disable")
    for what in ("rosout", "stdout", "external-lib")
}
