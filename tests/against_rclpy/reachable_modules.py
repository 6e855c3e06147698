"""Prints, as JSON, which modules of rclpy a program can reach as attributes after one import line.

{import line: [module, ...]}. It is run as a program. Each line runs in a process of its own, forked after
`import rclpy`, because every import of one of its modules begins with that.
"""

from __future__ import annotations

import importlib
import json
import os
import sys
import types

from describe_api import MODULES


def reachable() -> list[str]:
    """Return the public modules that attributes lead to from `rclpy`, by their path."""
    found, ways = [], [("rclpy", sys.modules["rclpy"])]
    while ways:
        path, module = ways.pop()
        found.append(path)
        for name, value in vars(module).items():
            way = f"{path}.{name}"
            if isinstance(value, types.ModuleType) and value.__name__ == way and way in MODULES:
                ways.append((way, value))
    return sorted(found)


def after(module: str) -> list[str]:
    """Return what is reachable after an import, found in a process of its own."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        importlib.import_module(module)
        with os.fdopen(writer, "w") as pipe:
            json.dump(reachable(), pipe)
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader) as pipe:
        text = pipe.read()
    os.waitpid(child, 0)
    found: list[str] = json.loads(text)
    return found


if __name__ == "__main__":
    importlib.import_module("rclpy")
    for _others in ("rcl_interfaces.msg", "rcl_interfaces.srv", "action_msgs.srv", "lifecycle_msgs.srv"):
        importlib.import_module(_others)  # once for all lines
    json.dump({f"import {module}": after(module) for module in MODULES}, sys.stdout)
