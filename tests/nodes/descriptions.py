"""Any description of a node that the reader accepts, drawn by hypothesis, and the package made from it."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TypeVar
from zlib import crc32

from hypothesis import HealthCheck, Phase, assume, given, seed, settings
from hypothesis import strategies as st
from ifgen.definition.interfaces import Registry
from ifgen.diagnostics import Source, Span, any_errors
from ifgen.generator_py.nodes.package import plan_nodes, plan_users_files
from ifgen.generator_py.templates.render import Templates
from ifgen.generator_py.tests.package import plan_node_tests, plan_users_tests
from ifgen.nodl.document import Written
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
from ifgen.nodl.names import expanded
from ifgen.nodl.rules import check_node
from ifgen.pipeline import stages

Drawn = TypeVar("Drawn")

ROOT = Path(__file__).parents[2]
OWN_MESSAGES = Path(__file__).with_name("own_msgs")
TYPES = {
    "msg": [
        *("std_msgs/msg/String", "geometry_msgs/msg/Pose", "rcl_interfaces/msg/Parameter"),
        "own_msgs/msg/Speed",
    ],
    "srv": ["std_srvs/srv/Trigger", "lifecycle_msgs/srv/GetState", "own_msgs/srv/SetSpeed"],
    "action": ["example_interfaces/action/Fibonacci", "own_msgs/action/Drive"],
}

SPAN = Span(Source(Path("node.nodl.yaml"), "x"), 0, 1)
"""Where everything stands, for the rules want to say so."""
NOTHING_ELSE = Written(frozenset(), frozenset(), frozenset())
"""No document names more than what a node has."""

CHARACTERS = st.characters(exclude_categories=["Cs"], exclude_characters="\0")
words = st.text(CHARACTERS, max_size=150) | st.sampled_from(
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
    lambda history, **policies: QosProfile(history=history[0], depth=history[1], span=SPAN, **policies),
    st.sampled_from([("KEEP_ALL", 0), ("SYSTEM_DEFAULT", 0), ("KEEP_LAST", 1), ("KEEP_LAST", 10)]),
    reliability=st.sampled_from(["RELIABLE", "BEST_EFFORT", "SYSTEM_DEFAULT", "BEST_AVAILABLE"]),
    durability=st.sampled_from([None, "TRANSIENT_LOCAL", "VOLATILE"]),
    deadline_ns=st.sampled_from([0, 10**8]),
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
def endpoints(draw: st.DrawFn, category: Category, node: str) -> tuple[Endpoint, ...]:
    found = {}
    for name in draw(st.lists(topics, max_size=3)):
        qos = None if category.folder == "action" else draw(profiles)
        if category.folder == "srv" and draw(st.booleans()):
            qos = None
        full_name = expanded(name, node)
        # A name has one type in a node, whoever uses it.
        types = TYPES[category.folder]
        type_name = types[crc32(full_name.encode()) % len(types)]
        found[full_name] = Endpoint(category, name, type_name, draw(words), qos, span=SPAN)
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
                span=SPAN,
            )
        )
    return tuple(found)


@st.composite
def descriptions(draw: st.DrawFn, number: int = 0) -> NodeDescription:
    name = f"node{number}"
    of = {category: draw(endpoints(category, name)) for category in Category}
    publishers = [publisher.name for publisher in of[Category.PUBLISHER]]
    timers = {
        name: Timer(
            name,
            period=draw(st.sampled_from([0.1, 0.02, 1.0]) | st.floats(1e-3, 1e3)),
            clock=draw(st.sampled_from(["ros", "steady", "system"])),
            span=SPAN,
            publishes=tuple(draw(st.lists(st.sampled_from(publishers), unique=True))) if publishers else (),
        )
        for name in draw(st.lists(names, max_size=2))
    }
    node = NodeDescription(
        package="any_nodes",
        name=name,
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
    assume(not any_errors(check_node(node, NOTHING_ELSE)))
    return node


def render(nodes: tuple[NodeDescription, ...]) -> dict[str, str]:
    package = NodePackage("any_nodes", Path(), nodes)
    templates = Templates()
    artifacts = [*plan_nodes(package), *plan_users_files(package)]
    artifacts += [*plan_node_tests(package, interfaces()), *plan_users_tests(package, interfaces())]
    files = map(templates.render, artifacts)
    return {file.path: file.text for file in files}


@cache
def interfaces() -> Registry:
    return stages.load(ROOT / "interfaces", OWN_MESSAGES)


def one(strategy: st.SearchStrategy[Drawn], number: int) -> Drawn:
    """A value that a strategy draws: another one for each number, and the same ones each time."""
    found: list[Drawn] = []

    @seed(number)
    @given(strategy)
    @settings(max_examples=3, phases=[Phase.generate], suppress_health_check=list(HealthCheck))
    def draw(value: Drawn) -> None:
        found.append(value)

    draw()
    return found[-1]  # the first ones are as simple as possible


def drawn(count: int) -> tuple[NodeDescription, ...]:
    """The given number of descriptions, always the same, of nodes called node0, node1 and so on in one package."""
    found: list[NodeDescription] = []
    for number in range(count):
        found.append(one(descriptions(number), number))
    return tuple(found)


def write(nodes: tuple[NodeDescription, ...], folder: Path) -> Path:
    """Write the package of nodes as `ifgen generate` does; returns its folder."""
    package = folder / "any_nodes"
    for name, text in render(nodes).items():
        path = package / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    (package / ".ifgen-manifest.json").touch()
    return package
