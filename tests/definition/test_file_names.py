"""A package cannot have the name of a package that generated code imports."""

from __future__ import annotations

import ast
import keyword
import subprocess
import sys
from pathlib import Path

from ifgen import resources
from ifgen.definition.file_names import NEEDED, problem

ROOT = Path(__file__).parents[2]


def imported(folder: Path) -> set[str]:
    """The top-level packages that the modules in a folder import from elsewhere."""
    names: set[str] = set()
    for path in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_bytes())):
            if isinstance(node, ast.Import):
                names.update(alias.name.partition(".")[0] for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and not node.level and node.module:
                names.add(node.module.partition(".")[0])
    return names


def test_all_that_is_imported_is_needed() -> None:
    """The list has everything that generated packages, their tests, our runtime and our rclpy import."""
    packages = {path.name for path in resources.bundled_interfaces().iterdir()}
    packages.add("humanoid")  # the library of the example's nodes, importable only with them
    folders = (resources.bundled_generated(), resources.underlay(), ROOT / "codegen/ifgen_runtime")
    private = {name for name in sys.stdlib_module_names if name.startswith("_")}
    needed = set[str]().union(*map(imported, folders)) - packages - private
    assert needed <= NEEDED, "add what is new to file_names.NEEDED"


PROGRAM = """
import sys
import ifgen
ifgen.activate("local")
import hypothesis, numpy, pytest, rclpy, yaml
from ifgen_runtime import convert, serialize
from std_msgs.msg import String
rclpy.init()
rclpy.spin_once(rclpy.create_node("alone"), timeout_sec=0.01)
serialize(String())
for name, module in list(sys.modules.items()):
    if getattr(getattr(module, "__spec__", None), "origin", None) not in {None, "built-in", "frozen"}:
        print(name.partition(".")[0])
"""


def test_all_of_pythons_own_that_is_imported_in_turn_is_needed() -> None:
    """Built-in modules and those that Python has already imported at start cannot be hidden."""
    loaded = subprocess.check_output([sys.executable, "-c", PROGRAM], text=True, timeout=60).split()
    own = {name for name in loaded if name in sys.stdlib_module_names and not name.startswith("_")}
    assert len(own) > 50
    assert own <= NEEDED, "add what is new to file_names.NEEDED"


def test_what_can_be_a_package() -> None:
    for name in ("match", "type", "msg", "demo_msgs", "std_msgs"):
        assert problem(name) is None
    for name in (*keyword.kwlist, *NEEDED):
        found = problem(name)
        assert found is not None
        assert found.severity == "error"
