"""What generated modules import is what they use, however templates and descriptions put them together."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from ifgen.config.customization import Customization
from ifgen.definition.interfaces import Field, InterfacePackage, Message, Registry
from ifgen.definition.types import BasicType
from ifgen.generator_py.imports import gathered
from ifgen.generator_py.messages.package import plan
from ifgen.generator_py.nodes import members as of_nodes
from ifgen.generator_py.nodes.package import plan_nodes, plan_users_files
from ifgen.generator_py.templates.render import OutputFile, Templates
from ifgen.generator_py.tests import contract
from ifgen.generator_py.tests.package import plan_node_tests, plan_users_tests
from ifgen.nodl.load import load
from ifgen.nodl.model import NodeDescription, NodePackage
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath

ROOT = Path(__file__).resolve().parents[2]
TEMPLATES = ROOT / "templates"
GROUPS = ("contract", "topics", "services", "actions", "parameters", "rates")
MEMBERS = (
    *("publishers", "subscriptions", "service_servers", "service_clients"),
    *("action_servers", "action_clients", "timers", "parameters"),
)

GATHERED = {
    "merged and sorted": (
        "import sys\nimport os\nfrom b import y\nfrom typing import Any\nfrom b import x as z\n\nclass A:\n",
        "import os\nimport sys\nfrom typing import Any\n\nfrom b import y\nfrom b import x as z\n\nclass A:\n",
    ),
    "out of the middle of a class": (
        "from typing import Any\n\n\nclass A:\nfrom own.x import b\nimport a\n\n    x: Any = a.b(b)\n",
        "from typing import Any\n\nimport a\n\nfrom own.x import b\n\n\nclass A:\n\n    x: Any = a.b(b)\n",
    ),
    "each to its run at the top": (
        "import pytest\n\npytest.importorskip('a')\n\nimport a\n\n\ndef f():\nimport os\nfrom b import c\n    c()\n",
        "import os\n\nimport pytest\n\npytest.importorskip('a')\n\nimport a\nfrom b import c\n\n\ndef f():\n    c()\n",
    ),
    "over several lines": (
        "from b import (\n    x,\n    y,\n)\n\n\n@x\nclass A:\nfrom b import (\n    z,\n)\n    y = z\n",
        "from b import x, y, z\n\n\n@x\nclass A:\n    y = z\n",
    ),
    "nothing at the top": ("def f():\nimport a\n    a.b()\n", "import a\ndef f():\n    a.b()\n"),
    "a file that formatters leave alone": (
        "# fmt: off\n\nimport b\n\n# fmt: off\nimport a\nX = 1\n",
        "# fmt: off\n\nimport a\nimport b\n\n# fmt: off\nX = 1\n",
    ),
    "no statement": ("'''Says\nfrom where\nimport is\n'''\nX = 1\n", None),
    "words of a docstring": ('"""Take it\nfrom here import there\n"""\n\nimport a\n\nX = 1\n', None),
    "a text": ('import a\n\nTEXT = """\nimport b\n"""\nimport_ = a\n', None),
    "a comment": ("import b\nimport a  # first\n\nX = 1\n", None),
    "inside": ("import b\n\nif b:\n    import a\n", None),
    "of the package's own folder": ("from . import a\nfrom .b import c\n\nX = a\n", None),
    "of the future": ("from __future__ import annotations\n\nX = 1\n", None),
}


@pytest.mark.parametrize("case", GATHERED)
def test_import_lines_go_to_the_top(case: str) -> None:
    """What is not an import statement at the margin stays where it is."""
    text, expected = GATHERED[case]
    assert gathered(text, "own") == (text if expected is None else expected)
    assert gathered(gathered(text, "own"), "own") == gathered(text, "own")


def written(templates: str, pattern: str) -> set[str]:
    """The names with a capital letter that lines of templates import, or define."""
    texts = [path.read_text() for path in TEMPLATES.glob(templates)]
    found = [
        name for text in texts for names in re.findall(pattern, text, re.M) for name in names.split(", ")
    ]
    return {name for name in found if name[:1].isupper() and not name.isupper()}


def test_what_templates_import_is_taken() -> None:
    """An interface or a node that is called so gets another name in the module."""
    imports = r"^from [\w.]+ import ([\w, ]+)$"
    parts = ("base.py", "entities", "lifecycle", "node.py", "parameters.py", "timers")
    of_node = {name for part in parts for name in written(f"node_package/{part}.j2", imports)}
    assert of_node > {"Any", "ExitStack", "LifecycleState"}
    assert of_node <= of_nodes.TAKEN
    of_tests = written("test_package/contract*.j2", imports) | written("test_package/strategies.j2", imports)
    of_tests |= written("test_package/contract*.j2", r"^class (\w+)")
    assert of_tests > {"GoalStatus", "Path", "Topic"}
    assert of_tests <= contract.TAKEN


def variants(node: NodeDescription) -> Iterator[NodeDescription]:
    """The node without some of its members, and with only some of its tests."""
    yield node
    for member in MEMBERS:
        yield without(node, {member})
        yield without(node, {*MEMBERS} - {member})
    for group in GROUPS:
        yield replace(node, tests=(group,))


def without(node: NodeDescription, members: set[str]) -> NodeDescription:
    if "parameters" in members:  # which may be the periods of timers
        node = replace(node, timers=tuple(timer for timer in node.timers if timer.period is not None))
    return replace(node, **dict.fromkeys(members, ()))


def rendered(package: NodePackage, registry: Registry) -> Iterator[OutputFile]:
    templates = Templates()
    planned = (
        *plan_nodes(package),
        *plan_users_files(package),
        *plan_node_tests(package, registry),
        *plan_users_tests(package, registry),
    )
    for artifact in planned:
        yield templates.render(artifact)


def test_modules_of_nodes_import_what_they_use(tmp_path: Path) -> None:
    """Whatever a node has, and whatever its tests are about."""
    packages = find_packages([ROOT / "tests/nodes/packages"])
    nodes = load(packages, SearchPath(packages, [ROOT / "interfaces", ROOT / "tests/nodes/own_msgs"]))
    [package] = nodes.packages
    assert {node.style for node in package.nodes} == {"callbacks", "lifecycle", "asyncio"}
    for node in package.nodes:
        for number, variant in enumerate(variants(node)):
            for file in rendered(replace(package, nodes=(variant,)), nodes.registry):
                if file.path.endswith(".py"):
                    path = tmp_path / f"{node.name}_{number}" / file.path
                    path.parent.mkdir(parents=True, exist_ok=True)
                    path.write_text(file.text)
    # The user's node imports all messages that it is about, used or not.
    ruff = [sys.executable, "-m", "ruff", "check", "--isolated", "--no-cache", "--output-format=concise"]
    rules = ["--select=F401,F811,F821", "--per-file-ignores=**/robot/[!_]*.py:F401"]
    done = subprocess.run([*ruff, *rules, tmp_path], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stdout[-3000:]


def message_text(folder: Path, *fields: Field) -> str:
    package = InterfacePackage("p_msgs", (Message("p_msgs", "msg", "Point", fields),))
    *_, artifact = plan(package, Registry.of({"p_msgs": package}, ("p_msgs",)))
    return Templates(Customization(folder)).render(artifact).text


def test_a_template_of_a_user_imports_what_it_needs(tmp_path: Path) -> None:
    """Beside its text, and in a module whose names collide with ours as in others."""
    template = tmp_path / "message_package/message.j2"
    template.parent.mkdir()
    template.write_text(
        '{% extends "ifgen/message_package/message.j2" %}\n{% block additions %}\nfrom math import hypot\n\n'
        "    def norm(self) -> Any{{ module.mark }}:\n        return hypot(self.x, self.x)\n{% endblock %}\n"
    )
    x = Field("x", BasicType("double"))
    text = message_text(tmp_path, x)
    assert text.index("from math import hypot\n") < text.index("class Point")
    assert "    def norm(self) -> Any:\n" in text
    text = message_text(tmp_path, x, Field("property", BasicType("double")))
    assert "from typing import Any as Any_\n" in text
    assert "    def norm(self) -> Any_:\n" in text
