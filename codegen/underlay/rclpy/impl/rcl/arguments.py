"""`--ros-args`: remap rules, parameters, log levels and switches, of a process (context) or of one node."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

from .handle import RCLError, RCLInvalidROSArgsError, UnknownROSArgsError
from .logging import (
    RCUTILS_LOG_SEVERITY,
    rclpy_logging_rcutils_log,
    rclpy_logging_severity_level_from_string,
)
from .names import rclpy_get_validation_error_for_namespace
from .parameters import ParameterOverrides, parse_override_rule, read_file
from .rules import Lexeme, Lexer, RemapRule, RuleError, parse_remap_rule


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
