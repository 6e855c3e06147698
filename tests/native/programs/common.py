"""Helpers of the programs: the path of our packages, spinning until a condition holds, resident memory."""

import importlib.util
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ifgen

ifgen.activate("rclpy")

import rclpy  # noqa: E402  # the path comes first
from rclpy.node import Node  # noqa: E402

GENERATED = Path(__file__).parents[3] / "generated"


def never_compiled(type_name: str) -> Any:
    """Our class of a type whose compiled class `import` finds, to have both in one process."""
    package, folder, name = type_name.split("/")
    compiled = getattr(__import__(f"{package}.{folder}", fromlist=[name]), name)
    module_name = compiled.__module__
    path = GENERATED / package / folder / f"{module_name.rpartition('.')[2]}.py"
    specification = importlib.util.spec_from_file_location(module_name, path)
    assert specification is not None and specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    compiled_module = sys.modules[module_name]
    sys.modules[module_name] = module  # a class looks up its source there
    try:
        specification.loader.exec_module(module)
    finally:
        sys.modules[module_name] = compiled_module
    return getattr(module, name)


def spin_until(node: Node, holds: Callable[[], object], limit: float = 10.0) -> bool:
    """Spin until the condition holds; False after `limit` [s]."""
    end = time.monotonic() + limit
    while not holds() and time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.02)
    return bool(holds())


def resident_kib() -> int:
    """The memory of this process [KiB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * 4
