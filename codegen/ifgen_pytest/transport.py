"""`--transport`: where rclpy comes from while tests run; `both` runs them once on each, in processes."""

from __future__ import annotations

import os
import subprocess
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import pytest

# Late imports: pytest loads the plugin in projects too that never use it.

CHOICES = ("local", "rclpy", "auto", "both")
_OPTION = "--transport"
_WAY = """run `pytest --transport local` (or rclpy, auto, both),
or write `transport = "local"` under [tool.pytest.ini_options]"""


def asked(config: pytest.Config, arguments: list[str]) -> str | None:
    """The transport that the command line, or else the configuration file, asks for; None if neither does.

    Read before pytest's parser knows the option. Raises UsageError for a wrong word in the configuration.
    """
    words: list[str | None] = [getattr(config.option, "transport", None)]  # of a worker of pytest-xdist
    for index, word in enumerate(arguments):
        if word == "--":
            break
        if word.startswith(f"{_OPTION}="):
            words.append(word.partition("=")[2])
        elif word == _OPTION and index + 1 < len(arguments):
            words.append(arguments[index + 1])
    configured: str = config.getini("transport")
    if configured and configured not in CHOICES:
        raise pytest.UsageError(f"transport must be one of {', '.join(CHOICES)}, not {configured!r}")
    # A word that is not ours belongs to another plugin's option, or the parser refuses it later.
    return next((word for word in reversed(words) if word in CHOICES), None) or configured or None


def add_option(parser: pytest.Parser) -> None:
    """Let the parser know the option, unless the project has one of that name."""
    _, unknown = parser.parse_known_and_unknown_args([f"{_OPTION}=auto"])
    if unknown:
        group = parser.getgroup("ifgen")
        group.addoption(
            _OPTION,
            choices=CHOICES,
            help="where rclpy comes from: ifgen's local transport, the real one, the real one if it is "
            "installed (auto), or first local and then rclpy (both)",
        )


def activate(transport: str, arguments: list[str]) -> str:
    """Put the transport's and the user's packages ([tool.ifgen], or around the tests) on `sys.path`.

    Returns which transport it is. Raises UsageError if it cannot.
    """
    from ifgen.activation import ActivationError, folder_around, put_on_path
    from ifgen.config.settings import settle
    from ifgen.diagnostics import UsageError

    try:
        around = (folder_around(Path(word.partition("::")[0])) for word in arguments if word[:1] != "-")
        own = next(filter(None, around), None) or settle().output
        return put_on_path(transport, own)  # type: ignore[arg-type]  # one of the choices
    except (ActivationError, UsageError) as error:
        raise pytest.UsageError(str(error)) from None


def run_on_both(config: pytest.Config) -> int:
    """Run these tests again in one process for each transport; returns the worst of the two exit codes.

    Where there is no real rclpy, its half counts as `--transport rclpy` does there: as a usage error.
    """
    arguments = _without_option(list(config.invocation_params.args))
    # `python -m pytest` lets tests import from the current folder, and `pytest` does not.
    isolated = [] if {"", str(Path.cwd())} & set(sys.path) else ["-P"]
    outcomes: dict[str, tuple[int, str]] = {}
    for transport in ("local", "rclpy"):
        if transport == "rclpy" and (reason := _no_rclpy()):
            outcomes[transport] = (pytest.ExitCode.USAGE_ERROR, f"did not run: {reason}")
            continue
        print(f"transport {transport}", flush=True)  # before what another process prints
        command = [sys.executable, *isolated, "-m", "pytest", _OPTION, transport, *arguments]
        code = subprocess.run(command, cwd=config.invocation_params.dir, check=False).returncode
        code = code if code >= 0 else 128 - code
        outcomes[transport] = (code, "passed" if code == 0 else f"exit code {code}")
    print("both transports")
    for transport, (_, word) in outcomes.items():
        print(f"  {transport}: {word}", flush=True)
    return max(code for code, _ in outcomes.values())


def _without_option(arguments: list[str]) -> list[str]:
    kept: list[str] = []
    rest = iter(arguments)
    for word in rest:
        if word == "--":
            return [*kept, word, *rest]
        if word == _OPTION:
            next(rest, None)
        elif not word.startswith(f"{_OPTION}="):
            kept.append(word)
    return kept


def _no_rclpy() -> str | None:
    """The reason why there is no real rclpy; None if there is one. Changes and imports nothing."""
    from ifgen.activation import ActivationError, put_on_path

    before = list(sys.path)
    try:
        put_on_path("rclpy", None)
    except ActivationError as error:
        return str(error)
    finally:
        sys.path[:] = before
    return None


def hint(error: BaseException | None) -> str | None:
    """Advice for a missing module that is in the project's output folder, or comes with ifgen."""
    for name in _missing(error):
        from ifgen import resources
        from ifgen.config.settings import settle
        from ifgen.diagnostics import UsageError

        try:
            output = settle().output
        except UsageError:
            continue
        if (output / name).is_dir():
            return f"'{name}' is in {os.path.relpath(output)}: {_WAY}"
        folders = (resources.underlay(), resources.bundled_generated(), resources.libraries())
        if any((folder / name).is_dir() for folder in folders):
            return f"'{name}' comes with ifgen: {_WAY}"
    return None


def skips(reports: Iterable[Any]) -> Iterator[str]:
    """The reasons why files of tests that ifgen generated were skipped, with commands that help."""
    found: Counter[str] = Counter()
    for report in reports:
        if isinstance(report.longrepr, tuple):  # file, line, reason
            _, ours, reason = str(report.longrepr[2]).partition("Skipped: ifgen: ")
            if ours:
                found[reason] += 1
    for reason, count in found.items():
        line = f"ifgen: {count} {'file' if count == 1 else 'files'} skipped: {reason}"
        if "hypothesis" in reason:
            from ifgen.config.installing import add_extra

            line = f"{line}: run `{add_extra('test')}`"
        yield line


def _missing(error: BaseException | None) -> Iterator[str]:
    while error is not None:
        if isinstance(error, ModuleNotFoundError) and error.name:
            yield error.name.partition(".")[0]
        error = error.__cause__ or error.__context__
