"""`ifgen nodl describe`: the description of a running node is true, and ifgen can read it."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, Literal

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from ifgen import generate
from ifgen.nodl.model import (
    Category,
    Endpoint,
    NodeDescription,
    Parameter,
    ParameterType,
    QosProfile,
    Validator,
)
from ifgen.nodl.names import expanded
from ifgen_tools import ros_graph
from ifgen_tools.nodl.document import as_json, as_yaml, document_of
from ifgen_tools.nodl.node_verbs import choose
from ifgen_tools.nodl.parameters import RunningParameter

from tests.nodl.conftest import load_from

WALKER = Path(__file__).parent / "walker.py"
needs_rclpy = pytest.mark.skipif(importlib.util.find_spec("rclpy") is None, reason="there is no real rclpy")
TRANSPORTS = ["local", pytest.param("rclpy", marks=needs_rclpy)]
SLOWLY_ON_REAL = ["local", pytest.param("rclpy", marks=[needs_rclpy, pytest.mark.slow])]


def run(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run `ifgen nodl describe` in a process."""
    return ifgen_nodl(folder, "describe", *words)


def ifgen_nodl(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run `ifgen nodl` in a process."""
    command = [sys.executable, "-m", "ifgen", "nodl", *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, cwd=folder, check=False)


def read(tmp_path: Path, text: str) -> NodeDescription:
    """The description that ifgen reads from a text."""
    return load_from(tmp_path, {"demo/nodl/walker.nodl.yaml": text}).node


@pytest.mark.parametrize("transport", TRANSPORTS)
def test_a_node_with_everything(tmp_path: Path, transport: str) -> None:
    done = run(tmp_path, "--transport", transport, "--", str(WALKER))
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("# left out: parameter 'a.flags'"), done.stdout  # no other output
    assert "the program's own output" in done.stderr
    assert "# left out: parameter 'bad-name'" in done.stdout
    node = read(tmp_path, done.stdout)

    def qos(depth: int, reliability: Literal["RELIABLE", "BEST_EFFORT"], **others: Any) -> QosProfile:
        if transport == "local":
            return QosProfile("KEEP_LAST", reliability, depth, **others)
        return QosProfile("SYSTEM_DEFAULT", reliability, **others)  # DDS reports neither

    volatile = qos(10, "RELIABLE", durability="VOLATILE")
    latched = qos(3, "RELIABLE", durability="TRANSIENT_LOCAL", deadline_ns=10**9)
    sensor = qos(1, "BEST_EFFORT", durability="VOLATILE")
    string, trigger, fibonacci = (
        "std_msgs/msg/String",
        "std_srvs/srv/Trigger",
        "example_interfaces/action/Fibonacci",
    )
    assert node.endpoints == (
        Endpoint(Category.PUBLISHER, "/b", string, qos=volatile),
        Endpoint(Category.PUBLISHER, "~/a", string, qos=latched),
        Endpoint(Category.SUBSCRIPTION, "/robot/c", string, qos=sensor),
        Endpoint(Category.SERVICE_SERVER, "~/go", trigger),
        Endpoint(Category.SERVICE_CLIENT, "/other/stop", trigger),
        Endpoint(Category.ACTION_SERVER, "/robot/fib", fibonacci),
        Endpoint(Category.ACTION_CLIENT, "/other/fib", fibonacci),
    )
    assert node.parameters == (
        Parameter("a", ParameterType("int"), 1),
        Parameter(
            "gain",
            ParameterType("double"),
            1.5,
            "it's: how\nmuch",
            validators=(Validator("bounds", (0.0, 2.0)),),
        ),
        Parameter("inf", ParameterType("double"), float("inf")),
        Parameter("n", ParameterType("int"), 3, read_only=True, validators=(Validator("bounds", (-1, 10)),)),
        Parameter("unset", ParameterType("double")),
    )


def test_a_generated_node(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The node that ifgen makes from a description has the endpoints and parameters that it describes."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    text = (Path(__file__).parents[2] / "nodl/examples/gait_planner.nodl.yaml").read_text()
    before = load_from(tmp_path / "source", {"demo/nodl/gait_planner.nodl.yaml": text}).node
    generate(tmp_path / "source", output=tmp_path / "generated")
    done = run(tmp_path, "--transport", "local", "--", "-m", "demo.gait_planner")
    assert done.returncode == 0, done.stderr
    after = read(tmp_path / "again", done.stdout)

    def endpoints(node: NodeDescription, name: str) -> set[tuple[object, ...]]:
        return {
            (
                e.category,
                expanded(e.name, name),
                e.type_name,
                *((q.history, q.depth, q.reliability, q.durability or "VOLATILE") if q else ()),
            )
            for e, q in ((e, e.qos) for e in node.endpoints)
        }

    assert endpoints(after, "gait_planner") == endpoints(before, "gait_planner")
    assert {p.name: (p.default, p.read_only, p.description) for p in after.parameters} == {
        p.name: (p.default, p.read_only, p.description) for p in before.parameters
    }


@pytest.mark.parametrize("transport", SLOWLY_ON_REAL)
def test_one_of_several_nodes_and_files(tmp_path: Path, transport: str) -> None:
    """NODE selects one; the file is not overwritten; the style of a lifecycle node is found."""
    programs = ["--", str(WALKER), ":", str(WALKER), "--lifecycle"]
    unclear = run(tmp_path, "--transport", transport, *programs)
    assert unclear.returncode == 2
    assert "name one of them: /manager, /robot/walker" in unclear.stderr
    done = run(tmp_path, "manager", "-o", "manager.nodl.yaml", "--transport", transport, *programs)
    assert (done.returncode, done.stdout) == (0, "manager.nodl.yaml: node /manager\n"), done.stderr
    node = read(tmp_path, (tmp_path / "manager.nodl.yaml").read_text())
    assert (node.style, node.parameters) == ("lifecycle", ())
    assert [endpoint.name for endpoint in node.endpoints] == ["~/go"]
    again = run(tmp_path, "manager", "-o", "manager.nodl.yaml", *programs)
    assert again.returncode == 2
    assert "--force" in again.stderr


@pytest.mark.slow
def test_no_node(tmp_path: Path) -> None:
    nothing = run(tmp_path, "--transport", "local")
    assert nothing.returncode == 2
    assert "ifgen nodl describe -- talker.py" in " ".join(nothing.stderr.split())
    (tmp_path / "broken.py").write_text("raise SystemExit(3)\n")
    for words in (["--", "nowhere.py"], ["--"]):
        assert run(tmp_path, "--transport", "local", *words).returncode == 2
    assert choose(["/a/n", "/b/n"], "n") is None
    assert choose(["/a/n", "/b/n"], "/b/n") == "/b/n"


# A string of ROS cannot hold a NUL, so no node can tell of one.
texts = st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"]), max_size=6)
floats = st.floats()
of_types: dict[str, st.SearchStrategy[object]] = {
    "bool": st.booleans(),
    "int": st.integers(-(2**63), 2**63 - 1),
    "double": floats,
    "string": texts,
    "byte_array": st.lists(st.integers(0, 255)),
    "double_array": st.lists(floats),
    "string_array": st.lists(texts),
}
parameters = st.sampled_from(list(of_types)).flatmap(
    lambda type_: st.builds(
        RunningParameter,
        name=st.one_of(texts, st.sampled_from(["a", "a.b", "use_sim_time", "x-y", "b.c"])),
        type=st.just(type_),
        value=st.one_of(st.none(), of_types[type_]),
        description=texts,
        read_only=st.booleans(),
        additional_constraints=texts,
        bounds=st.one_of(st.none(), st.tuples(*[st.integers(-9, 9) if type_ == "int" else floats] * 2)),
        step=st.sampled_from([0, 1]),
    )
)
names = st.one_of(texts, st.sampled_from(["/n/a", "/a", "/a/b", "/n/_x", "/1", "a//b"]))


@settings(max_examples=25)
@given(
    st.lists(parameters, max_size=4, unique_by=lambda p: p.name),
    st.lists(st.tuples(names, st.sampled_from(Category)), max_size=5),
)
@example([RunningParameter("a", "string", "x\x85y", "\x85", False, "\u2028", None, 0)], [])
def test_whatever_is_seen_can_be_read(
    seen: list[RunningParameter], names: list[tuple[str, Category]]
) -> None:
    _can_be_read(seen, names)


@pytest.mark.slow
@settings(max_examples=100)
@given(
    st.lists(parameters, max_size=4, unique_by=lambda p: p.name),
    st.lists(st.tuples(names, st.sampled_from(Category)), max_size=5),
)
def test_much_that_is_seen_can_be_read(
    seen: list[RunningParameter], names: list[tuple[str, Category]]
) -> None:
    _can_be_read(seen, names)


def _can_be_read(seen: list[RunningParameter], names: list[tuple[str, Category]]) -> None:
    """Values are read back exactly, in both languages; what cannot be expressed is left out."""
    types = {
        "msg": "std_msgs/msg/String",
        "srv": "std_srvs/srv/Trigger",
        "action": "example_interfaces/action/Fibonacci",
    }
    qos = QosProfile("KEEP_ALL", "BEST_EFFORT")
    endpoints = [
        ros_graph.Endpoint("/n", name, category, types[category.folder], qos) for name, category in names
    ]
    document, omitted = document_of("/n", endpoints, seen)
    nodes: list[NodeDescription] = []
    for extension, text in (("yaml", as_yaml(document, omitted)), ("json", as_json(document, omitted))):
        with tempfile.TemporaryDirectory() as folder:
            nodes.append(load_from(Path(folder), {f"demo/nodl/n.nodl.{extension}": text}).node)
    if not any("JSON" in reason for reason in omitted):
        assert nodes[0] == nodes[1]
    by_name = {parameter.name: parameter for parameter in seen}
    for parameter in nodes[0].parameters:
        value = by_name[parameter.name].value
        expected = bytes(value) if parameter.type.base == "byte" and value is not None else value
        assert repr(parameter.default) == repr(tuple(expected) if isinstance(expected, list) else expected)


def test_what_nodl_cannot_say(tmp_path: Path) -> None:
    """It is left out with a message; the rest can be read back, as YAML and as JSON."""
    qos = QosProfile("KEEP_LAST", "RELIABLE", 5, "VOLATILE", liveliness="AUTOMATIC")
    endpoints = [
        ros_graph.Endpoint("/n", "/n/a", Category.PUBLISHER, "std_msgs/msg/String", qos),
        ros_graph.Endpoint("/n", "/n/a", Category.PUBLISHER, "std_msgs/msg/Bool", qos),
        ros_graph.Endpoint("/n", "/n/_hidden", Category.PUBLISHER, "std_msgs/msg/Bool", qos),
        ros_graph.Endpoint("/n", "/x", Category.SERVICE_SERVER, "strange type", None),
        ros_graph.Endpoint("/other", "/y", Category.PUBLISHER, "std_msgs/msg/Bool", qos),
    ]
    document, omitted = document_of("/n", endpoints, None)
    assert document["publishers"][0]["qos"] == {
        "history": "KEEP_LAST",
        "depth": 5,
        "reliability": "RELIABLE",
        "durability": "VOLATILE",
    }
    assert [reason.split(":")[0] for reason in omitted] == [
        "the parameters",
        "another publisher /n/a (std_msgs/msg/Bool)",
        "service server /x (strange type)",
    ]
    node = read(tmp_path, as_yaml(document, omitted))
    assert [expanded(endpoint.name, "n") for endpoint in node.endpoints] == ["/n/_hidden", "/n/a"]
    (tmp_path / "demo/nodl/walker.nodl.yaml").unlink()
    assert load_from(tmp_path, {"demo/nodl/walker.nodl.json": as_json(document, omitted)}).node == node
