"""Whatever the reader lets through becomes Python as `ruff format` leaves it, and a node that starts."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from ifgen import pipeline
from ifgen.definition.interfaces import Registry
from ifgen.generator_py.node_package import plan_nodes, plan_users_files
from ifgen.generator_py.render import Templates
from ifgen.generator_py.test_package import plan_node_tests, plan_users_tests
from ifgen.nodl.model import (
    Category,
    Endpoint,
    NodeDescription,
    NodePackage,
    Parameter,
    ParameterType,
    ParameterValue,
    QosProfile,
    Timer,
    Validator,
)

ROOT = Path(__file__).parents[2]
TYPES = {
    "msg": ["std_msgs/msg/String", "geometry_msgs/msg/Pose", "rcl_interfaces/msg/Parameter"],
    "srv": ["std_srvs/srv/Trigger", "lifecycle_msgs/srv/GetState"],
    "action": ["example_interfaces/action/Fibonacci"],
}

words = st.text(st.characters(exclude_categories=["Cs"]), max_size=150) | st.sampled_from(
    ['"', '"""', "\\", "'", "'\"", "{{ x }}", "end.\\", "a\n\nb", "", "x" * 200, "#", "\u2028", "%}", "*/-->"]
)
names = st.from_regex(r"[a-z][a-zA-Z0-9]{0,3}(_[a-z0-9]{1,3})?", fullmatch=True) | st.sampled_from(
    ["create", "destroy", "activate", "parameters_changed", "x_timer", "self", "long" * 12]
)
topics = st.builds(
    lambda prefix, parts: prefix + "/".join(parts),
    st.sampled_from(["/", "~/", ""]),
    st.lists(names, min_size=1, max_size=2),
)
profiles = st.builds(
    QosProfile,
    st.sampled_from(["KEEP_ALL", "SYSTEM_DEFAULT"]),
    st.sampled_from(["RELIABLE", "BEST_EFFORT", "SYSTEM_DEFAULT", "BEST_AVAILABLE"]),
    durability=st.sampled_from([None, "TRANSIENT_LOCAL", "VOLATILE"]),
    deadline_ns=st.sampled_from([0, 10**7]),
    lifespan_ns=st.sampled_from([0, 10**9]),
    liveliness=st.sampled_from([None, "AUTOMATIC"]),
)
floats = st.floats(allow_nan=False)
SCALARS: dict[str, st.SearchStrategy[ParameterValue]] = {
    "bool": st.booleans(),
    "int": st.integers(-(2**63), 2**63 - 1),
    "double": floats,
    "string": words,
}


@st.composite
def endpoints(draw: st.DrawFn, category: Category) -> tuple[Endpoint, ...]:
    found = {}
    for name in draw(st.lists(topics, max_size=3)):
        qos = None if category.folder == "action" else draw(profiles)
        if category.folder == "srv" and draw(st.booleans()):
            qos = None
        type_name = draw(st.sampled_from(TYPES[category.folder]))
        found[name] = Endpoint(category, name, type_name, draw(words), qos)
    return tuple(found.values())


@st.composite
def parameters(draw: st.DrawFn) -> tuple[Parameter, ...]:
    found: list[Parameter] = []
    for number in range(draw(st.integers(0, 5))):
        base = draw(st.sampled_from(["bool", "int", "double", "string", "byte"]))
        array = base == "byte" or draw(st.booleans())
        default: ParameterValue | None
        if base == "byte":
            default = draw(st.binary(max_size=3))
        elif array:
            default = tuple(draw(st.lists(SCALARS[base], max_size=3)))  # type: ignore[arg-type]
        else:
            default = draw(SCALARS[base])
        validators: list[Validator] = []
        if base in {"int", "double"} and isinstance(default, int | float):
            limits = (-(2**63), 2**63 - 1) if base == "int" else (float("-inf"), float("inf"))
            validators.append(Validator("bounds", limits))
            validators.append(Validator("one_of", (default,)))
        elif array and default and base != "byte":
            validators.append(Validator("subset_of", tuple(default)))  # type: ignore[arg-type]
            validators.append(Validator("size_lt", (9,)))
        path = draw(st.lists(names, max_size=2))
        found.append(
            Parameter(
                ".".join([*(f"g_{word}" for word in path), f"p{number}"]),
                ParameterType(
                    base, array, draw(st.sampled_from([None, 200] if base in {"string"} else [None]))
                ),  # type: ignore[arg-type]
                default,
                draw(words),
                draw(st.booleans()),
                draw(words),
                tuple(validators),
            )
        )
    return tuple(found)


@st.composite
def descriptions(draw: st.DrawFn, number: int = 0) -> NodeDescription:
    of = {category: draw(endpoints(category)) for category in Category}
    timers = {
        name: Timer(name, period=draw(st.floats(1e-3, 1e3))) for name in draw(st.lists(names, max_size=2))
    }
    return NodeDescription(
        package="any_nodes",
        name=f"node{number}",
        description=draw(words),
        style=draw(st.sampled_from(["callbacks", "lifecycle", "asyncio"])),
        node_class=f"Node{number}",
        business_file=f"node{number}.py",
        parameters=draw(parameters()),
        publishers=of[Category.PUBLISHER],
        subscriptions=of[Category.SUBSCRIPTION],
        service_servers=of[Category.SERVICE_SERVER],
        service_clients=of[Category.SERVICE_CLIENT],
        action_servers=of[Category.ACTION_SERVER],
        action_clients=of[Category.ACTION_CLIENT],
        timers=tuple(timers.values()),
    )


def render(nodes: tuple[NodeDescription, ...]) -> dict[str, str]:
    package = NodePackage("any_nodes", Path(), nodes)
    templates = Templates()
    artifacts = [*plan_nodes(package), *plan_users_files(package)]
    artifacts += [*plan_node_tests(package, interfaces()), *plan_users_tests(package, interfaces())]
    files = map(templates.render, artifacts)
    return {file.path: file.text for file in files}


@given(descriptions())
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_all_of_it_is_python(node: NodeDescription) -> None:
    for path, text in render((node,)).items():
        if path.endswith(".py"):
            compile(text, path, "exec")


@cache
def interfaces() -> Registry:
    return pipeline.load(ROOT / "interfaces")


STARTS = """
import importlib, rclpy
rclpy.init()
for number in range({count}):
    module = importlib.import_module(f"any_nodes.node{{number}}")
    getattr(module, f"Node{{number}}")().destroy_node()
rclpy.shutdown()
print("started")
"""


@pytest.mark.slow
def test_it_is_formatted_and_starts(tmp_path: Path) -> None:
    found: list[NodeDescription] = []

    @given(descriptions())
    @settings(
        max_examples=40,
        deadline=None,
        database=None,
        derandomize=True,
        suppress_health_check=list(HealthCheck),
    )
    def collect(node: NodeDescription) -> None:
        number = len(found)
        found.append(
            replace(node, name=f"node{number}", node_class=f"Node{number}", business_file=f"node{number}.py")
        )

    collect()
    folder = tmp_path / "generated/any_nodes"
    for name, text in render(tuple(found)).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    (folder / ".ifgen-manifest.json").touch()
    lint = (ROOT / "pyproject.toml").read_text()
    (tmp_path / "pyproject.toml").write_text(lint[lint.index("[tool.ruff]") : lint.index("[tool.mypy]")])
    for arguments in (
        ["format", "--diff"],
        ["check", "--no-cache", "--output-format", "concise", "--ignore", "D301,RUF001,RUF002"],
    ):
        done = subprocess.run(
            [sys.executable, "-m", "ruff", *arguments, tmp_path / "generated"],
            capture_output=True, text=True, timeout=60, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout[-3000:]
    program = tmp_path / "program.py"
    program.write_text(STARTS.format(count=len(found)))
    done = subprocess.run(
        [sys.executable, "-m", "ifgen", "run", "--transport", "local", program],
        capture_output=True, text=True, timeout=100, check=False, cwd=tmp_path,
    )  # fmt: skip
    assert done.stdout == "started\n", done.stderr
