"""What a package cannot be called: what ROS does not allow, and what Python imports under that name."""

from __future__ import annotations

import keyword
import re
import sys
from typing import Final

from ifgen.definition import names
from ifgen.diagnostics import Diagnostic, Label, Severity
from ifgen.read import PackageFiles

NEEDED: Final = frozenset(
    (
        *("ifgen", "ifgen_native", "ifgen_pytest", "ifgen_runtime", "rclpy", "rmw_local", "rosidl_parser"),
        *("hypothesis", "launch", "launch_ros", "numpy", "pytest", "setuptools", "yaml"),
        *("__future__", "abc", "array", "asyncio", "builtins", "collections", "concurrent", "contextlib"),
        *("copy", "ctypes", "dataclasses", "enum", "functools", "heapq", "importlib", "inspect", "io"),
        *("itertools", "json", "logging", "math", "operator", "os", "pathlib", "queue", "random", "re"),
        *("select", "signal", "struct", "sys", "tempfile", "threading", "time", "traceback", "types"),
        *("typing", "unittest", "uuid", "warnings", "weakref"),
    )
)
"""What generated packages, their tests and rclpy import, and what that imports in turn."""


def check(package: PackageFiles) -> list[Diagnostic]:
    """What is wrong with a package's name."""
    name = package.name
    if not names.is_package_name(name):
        snake = re.sub(r"[^a-z0-9]+", "_", names.module_name(name)).strip("_")
        advice = "Package names are lower-case letters, digits and single underscores, a letter first"
        hint = f"did you mean '{snake}'? " if names.is_package_name(snake) and snake != name else ""
        return [
            _problem("invalid-package-name", package, f"'{name}' is not a valid package name", hint + advice)
        ]
    if keyword.iskeyword(name):
        message = f"no Python package can be called '{name}': `import {name}` is a syntax error"
        return [_problem("keyword-name", package, message, f"rename it, to '{name}_msgs' for example")]
    if name in NEEDED:
        message = (
            f"a package called '{name}' hides the Python package of that name, which generated code needs"
        )
        return [_problem("hiding-name", package, message, f"rename it, to '{name}_msgs' for example")]
    if name in sys.stdlib_module_names:
        message = f"a package called '{name}' hides a module of Python's own"
        advice = f"programs that import `{name}` may fail: rename it, to '{name}_msgs' for example"
        return [_problem("hiding-name", package, message, advice, "warning")]
    return []


def _problem(
    rule: str, package: PackageFiles, message: str, advice: str, severity: Severity = "error"
) -> Diagnostic:
    where = "" if package.declared else f" ({package.root})"
    label = Label(package.declared) if package.declared else None
    return Diagnostic(rule, message + where, label, help=advice, severity=severity)
