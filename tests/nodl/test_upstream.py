"""Documents that the ROS project's NoDL 2 accepts and refuses, and what they say once they are merged."""

from __future__ import annotations

import json
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import pytest
import yaml
from ifgen import generate
from ifgen.nodl import resolvers
from ifgen.nodl.barriers import OFFICIAL
from ifgen.nodl.load import Loaded
from ifgen.nodl.names import expanded
from ifgen.nodl.verdict import Verdict, verdict
from ifgen.reading.search_path import SearchPath
from ifgen_tools.nodl import rewriting

from . import documents

QOS = "qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}"
TOPIC = f"{{name: /a, type: std_msgs/msg/String, {QOS}}}"


def topic(name: str = "/a", type_: str = "std_msgs/msg/String", qos: str = QOS) -> str:
    return f"publishers: [{{name: '{name}', type: {type_}, {qos}}}]"


def qos(text: str) -> str:
    return topic(qos=f"qos: {{{text}}}")


def parameter(text: str, name: str = "p") -> str:
    return f"parameters: {{{name}: {{{text}}}}}"


def checked(type_: str, text: str) -> str:
    return parameter(f"type: {type_}, validation: {{{text}}}")


ACCEPTED = [
    "",
    "description: Talks.",
    "codegen: {}",
    "codegen: {cpp: {}, rust: {anything: [1, {a: b}]}}",
    "codegen: {cpp: {role: base_class}}",
    "codegen: {ifgen: {style: unheard, timers: 5, anything: [1]}}",
    "codegen: {cpp: {role: NODE, namespace: demo}}",
    "codegen: {python: {role: NO_GENERATE}}",
    "include: []",
    "parameters: {}",
    "publishers: []",
    *(parameter(f"type: {name}") for name in ("bool", "int", "double", "string", "none")),
    *(parameter(f"type: {name}_array") for name in ("bool", "int", "double", "string", "byte")),
    *(parameter(f"type: {name}_fixed_4") for name in ("string", "int_array", "double_array", "string_array")),
    parameter("type: int, default_value: 5, description: d, read_only: true, additional_constraints: even"),
    parameter("type: double, default_value: .nan"),
    parameter("type: byte_array, default_value: [0, 255]"),
    parameter("type: string", "a.b.c"),
    parameter("type: bool, default_value: false", "use_sim_time"),
    *(
        checked("int", text)
        for text in ("bounds: [0, 5]", "bounds<>: [0, 5]", "lt: 5", "lt: [5]", "gt<>: [0]")
    ),
    *(checked("double", text) for text in ("lt_eq: 5", "gt_eq: [0.5]", "one_of: [[1.0, 2.0]]")),
    *(
        checked("string", text)
        for text in ("not_empty:", "not_empty<>: []", "size_gt: 1", "one_of: [[a, b]]")
    ),
    *(checked("int_array", text) for text in ("unique:", "element_bounds: [0, 1]", "subset_of: [[1, 2]]")),
    *(checked("int_array", text) for text in ("fixed_size: 3", "lower_element_bounds: 0", "size_lt<>: [9]")),
    *(checked("int", text) for text in ("a::b:", "a::b: 5", "a::b: [1, x]", "a::b::c: true", "a::b: text")),
    *(topic(name) for name in ("/a", "a", "A", "~/a", "a/b", "/a/b", "a_", "a_b/C1")),
    *(topic(type_=name) for name in ("std_msgs/String", "nobody_msgs/msg/Nothing", "Caps_1/msg/A1")),
    "subscriptions: [" + TOPIC + "]",
    "publishers: [" + TOPIC + "]\nsubscriptions: [" + TOPIC + "]",
    *(qos(f"history: {word}, reliability: RELIABLE") for word in ("KEEP_ALL", "SYSTEM_DEFAULT")),
    qos("history: KEEP_ALL, depth: 3, reliability: RELIABLE"),
    *(
        qos(f"history: KEEP_ALL, reliability: {word}")
        for word in ("RELIABLE", "BEST_EFFORT", "SYSTEM_DEFAULT", "BEST_AVAILABLE")
    ),
    *(
        qos(f"history: KEEP_ALL, reliability: RELIABLE, {text}")
        for text in (
            "durability: TRANSIENT_LOCAL",
            "durability: VOLATILE",
            "durability: BEST_AVAILABLE",
            "liveliness: AUTOMATIC",
            "liveliness: MANUAL_BY_TOPIC",
            "deadline_ns: 0",
            "deadline_ns: 5",
            "lifespan_ns: 9000000000",
            "liveliness_lease_duration_ns: 1",
        )
    ),
    "service_servers: [{name: a, type: std_srvs/srv/Trigger}]",
    f"service_clients: [{{name: a, type: std_srvs/Trigger, {QOS}, description: d}}]",
    "action_servers: [{name: a, type: example_interfaces/action/Fibonacci}]",
    "action_clients: [{name: a, type: example_interfaces/Fibonacci, description: d}]",
    f"publishers: [{{name: a, type: x_msgs/A, {QOS}}}]\nservice_servers: [{{name: a, type: x_msgs/srv/B}}]",
    "include: [{ref: 'nodl://nodl_common_interfaces/node'}]",
    "include: [{ref: 'nodl://nodl_common_interfaces/lifecycle_node'}]",
    "include: [{ref: 'nodl://rclcpp/node'}]",
    "include: [{ref: 'nodl://rclpy/node'}]",
    "include: [{ref: 'nodl://rclpy/lifecycle_node'}]",
    "include: [{ref: 'nodl://rclcpp_lifecycle/lifecycle_node'}]",
    "include: [{ref: 'local://part.nodl.yaml'}]",
    "include: [{ref: 'local://sub/../part.nodl.yaml'}]",
]

REFUSED = [
    ("unknown-key", "include: [{ref: 'local://part.nodl.yaml', as: x}]"),
    ("invalid-include", "include: [{ref: 'nodl:///x'}]"),
    ("invalid-include", "include: [{ref: 'nodl://'}]"),
    ("invalid-include", "include: [{ref: 'nodl:/x'}]"),
    ("invalid-include", "include: [{ref: 'local://a b'}]"),
    ("invalid-include", "include: [{ref: 'nodl://a'}]"),
    ("unknown-include", "include: [{ref: 'test://x'}]"),
    ("unknown-include", "include: [{ref: 'local://nobody.yaml'}]"),
    ("unknown-include", "include: [{ref: 'nodl://nobody/none'}]"),
    (
        "duplicate-endpoint",
        f"publishers: [{{name: /part, type: std_msgs/msg/String, {QOS}}}]\ninclude: [{{ref: 'local://part.nodl.yaml'}}]",
    ),
    ("duplicate-parameter", "parameters: {shared: {type: int}}\ninclude: [{ref: 'local://part.nodl.yaml'}]"),
    ("included-twice", "include: [{ref: 'local://part.nodl.yaml'}, {ref: 'local://part.nodl.yaml'}]"),
    ("included-twice", "include: [{ref: 'local://talker.nodl.yaml'}]"),
    ("included-twice", "include: [{ref: 'local://loop.nodl.yaml'}]"),
    ("included-twice", "include: [{ref: 'local://one.nodl.yaml'}, {ref: 'local://two.nodl.yaml'}]"),
    ("included-twice", "include: [{ref: 'nodl://rclpy/node'}, {ref: 'nodl://rclcpp/node'}]"),
]
"""The rule of the first error, and the document, for documents with includes."""

OTHERS = {
    "part": f"parameters: {{shared: {{type: int}}}}\npublishers: [{{name: /part, type: std_msgs/String, {QOS}}}]",
    "one": "include: [{ref: 'local://part.nodl.yaml'}]",
    "two": "include: [{ref: 'local://part.nodl.yaml'}]",
    "loop": "include: [{ref: 'local://talker.nodl.yaml'}]",
}
SEARCH = SearchPath()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the documents that others include."""
    root = tmp_path_factory.mktemp("demo") / "demo" / "nodl"
    (root / "sub").mkdir(parents=True)
    for name, text in OTHERS.items():
        (root / f"{name}.nodl.yaml").write_text(f"nodl_version: 2\n{text}\n")
    return root


def judge(folder: Path, text: str, *, follow: bool = True) -> Verdict:
    path = folder / "talker.nodl.yaml"
    path.write_text(text, newline="")
    return verdict(path, SEARCH, follow=follow)


def document(text: str) -> str:
    return f"nodl_version: 2\n{text}\n"


def plainly_merged(path: Path) -> dict[str, Any]:
    """What PyYAML reads in a document and its includes, the root first, then breadth first."""
    merged: dict[str, Any] = {}
    queue = [path]
    while queue:
        current = queue.pop(0)
        read = yaml.safe_load(current.read_text())
        for key, value in read.items():
            if key == "parameters":
                merged.setdefault(key, {}).update(value)
            elif isinstance(value, list) and key != "include":
                merged[key] = merged.get(key, []) + value
            elif current == path and key in {"nodl_version", "description"}:
                merged[key] = value
        for reference in (each["ref"] for each in read.get("include", ())):
            scheme, _, rest = reference.partition("://")
            official = tuple(rest.split("/", 1))
            queue.append(OFFICIAL[official] if scheme == "nodl" else current.parent / rest)
    return {key: value for key, value in merged.items() if value}


@pytest.mark.parametrize("text", [*map(document, ACCEPTED), *documents.ACCEPTED])
def test_accepted(folder: Path, text: str) -> None:
    """Its merged content is what PyYAML reads."""
    found = judge(folder, text)
    assert [each.message for each in found.errors] == []
    assert found.loaded is not None
    expected = plainly_merged(folder / "talker.nodl.yaml")
    read = yaml.safe_load(rewriting.merged(found.loaded))
    # NaN equals nothing, and a date is written as a text.
    assert str(read) == str(expected) or read == json.loads(json.dumps(expected, default=str))


@pytest.mark.parametrize(
    ("rule", "text"),
    [*((rule, document(text)) for rule, text in REFUSED), *documents.REFUSED, *documents.STRICTER],
)
def test_refused(folder: Path, rule: str, text: str) -> None:
    assert rule in {each.rule for each in judge(folder, text).errors}


def test_without_following(folder: Path) -> None:
    """As `--no-resolve` of `ros2 nodl`: what is not installed yet may be included."""
    missing = document("include: [{ref: 'nodl://nobody/none'}, {ref: 'test://x'}]")
    assert judge(folder, missing).errors
    assert not judge(folder, missing, follow=False).errors
    assert judge(folder, document("include: [{ref: nonsense}]"), follow=False).errors


def merged(folder: Path, text: str) -> Loaded:
    found = judge(folder, document(text))
    assert found.loaded is not None
    assert not found.errors
    return found.loaded


def test_the_root_comes_first_then_breadth_first(folder: Path) -> None:
    whole = merged(folder, f"{topic('/root')}\ninclude: [{{ref: 'local://one.nodl.yaml'}}]").whole
    assert [endpoint.name for endpoint in whole.endpoints] == ["/root", "/part"]
    assert [parameter.name for parameter in whole.parameters] == ["shared"]


LIFECYCLE = {
    *(
        "change_state",
        "get_state",
        "get_available_states",
        "get_available_transitions",
        "get_transition_graph",
    ),
}


@pytest.mark.parametrize("package", ["nodl_common_interfaces", "rclpy"])
def test_what_is_behind_a_barrier_is_inherited(folder: Path, package: str) -> None:
    loaded = merged(folder, f"{topic('/own')}\ninclude: [{{ref: 'nodl://{package}/lifecycle_node'}}]")
    node = loaded.description
    assert [endpoint.name for endpoint in node.endpoints] == ["/own"]
    assert node.parameters == ()
    assert node.style == "lifecycle"
    assert node.references == (f"nodl://{package}/lifecycle_node",)
    names = {expanded(endpoint.name, "n") for endpoint in node.inherited.endpoints}
    assert {f"/n/{name}" for name in LIFECYCLE} < names
    assert {"/rosout", "/parameter_events", "/n/list_parameters", "/n/transition_event"} < names
    assert [parameter.name for parameter in node.inherited.parameters] == ["use_sim_time"]
    assert len(loaded.whole.endpoints) == 15


def test_what_rclpy_makes_is_not_generated(folder: Path) -> None:
    """As in a base document without `codegen`, which earlier versions had."""
    service = "service_servers: [{name: ~/get_parameters, type: rcl_interfaces/srv/GetParameters}]"
    found = judge(folder, document(f"{topic('/rosout', 'rcl_interfaces/msg/Log')}\n{service}"))
    assert found.loaded is not None
    assert found.loaded.description.endpoints == ()
    assert len(found.loaded.description.reserved.endpoints) == 2
    assert [each.rule for each in found.warnings] == ["reserved-endpoint", "reserved-endpoint"]


def test_another_base_class(folder: Path) -> None:
    base = "codegen: {python: {role: BASE_CLASS, module: robot.base, class: RobotNode}}"
    (folder / "robot.nodl.yaml").write_text(document(f"{base}\n{topic('/status')}"))
    node = merged(folder, f"{topic('/own')}\ninclude: [{{ref: 'local://robot.nodl.yaml'}}]").description
    assert node.base is not None
    assert (node.base.module, node.base.name, node.base.publisher_method) == (
        *("robot.base", "RobotNode", "create_publisher"),
    )
    assert [endpoint.name for endpoint in node.inherited.endpoints] == ["/status"]
    assert node.references == ("nodl://demo/robot",)
    both = document("include: [{ref: 'local://robot.nodl.yaml'}, {ref: 'nodl://rclpy/node'}]")
    assert [each.rule for each in judge(folder, both).warnings] == ["two-bases"]


def test_a_base_of_cpp_is_the_same_base_of_python(folder: Path) -> None:
    """As nodl_common_interfaces 2.0.3 registers it."""
    base = "codegen: {cpp: {role: BASE_CLASS, class: 'rclcpp::Node', header: rclcpp/rclcpp.hpp}}"
    (folder / "cpp.nodl.yaml").write_text(document(f"{base}\n{topic('/status')}"))
    node = merged(folder, "include: [{ref: 'local://cpp.nodl.yaml'}]").description
    assert node.endpoints == ()


def test_there_are_enough_documents() -> None:
    accepted, refused = len(ACCEPTED) + len(documents.ACCEPTED), len(REFUSED) + len(documents.REFUSED)
    assert accepted >= 150
    assert refused >= 150


def test_the_installed_document_keeps_includes_and_codegen(tmp_path: Path) -> None:
    """Whoever includes it generates nothing for what is behind its barriers."""
    source = tmp_path / "in/demo/nodl"
    source.mkdir(parents=True)
    (source / "tf.nodl.yaml").write_text(
        document(f"codegen: {{python: {{role: NO_GENERATE}}}}\n{topic('/tf')}")
    )
    (source / "part.nodl.yaml").write_text(document(topic("/part")))
    refs = ("nodl://rclpy/lifecycle_node", "local://tf.nodl.yaml", "local://part.nodl.yaml")
    includes = "".join(f"  - ref: {ref}\n" for ref in refs)
    codegen = "codegen: {cpp: {role: NODE, namespace: demo}}"
    (source / "talker.nodl.yaml").write_text(document(f"{codegen}\n{topic('~/out')}\ninclude:\n{includes}"))
    generate(tmp_path / "in", output=tmp_path / "out")
    installed = yaml.safe_load((tmp_path / "out/demo/resource/demo__talker").read_text())
    assert installed["codegen"] == {"cpp": {"role": "NODE", "namespace": "demo"}}
    assert installed["include"] == [{"ref": "nodl://rclpy/lifecycle_node"}, {"ref": "nodl://demo/tf"}]
    assert [endpoint["name"] for endpoint in installed["publishers"]] == ["~/out", "/part"]
    part = yaml.safe_load((tmp_path / "out/demo/resource/demo__tf").read_text())
    assert part["codegen"] == {"python": {"role": "NO_GENERATE"}}
    code = (tmp_path / "out/demo/demo/_talker_base.py").read_text()
    assert "class TalkerBase(LifecycleNode):" in code
    assert (tmp_path / "out/demo/package.xml").read_text().count("<depend>rclpy</depend>") == 1
    assert "create_lifecycle_publisher" in code
    assert "tf" not in code


def test_the_package_of_a_base_class_is_a_dependency(tmp_path: Path) -> None:
    source = tmp_path / "in/demo/nodl"
    source.mkdir(parents=True)
    base = "codegen: {python: {role: BASE_CLASS, module: robot.base, class: RobotNode}}"
    (source / "base.nodl.yaml").write_text(document(base))
    (source / "talker.nodl.yaml").write_text(document("include: [{ref: 'local://base.nodl.yaml'}]"))
    generate(tmp_path / "in", output=tmp_path / "out")
    assert "<depend>robot</depend>" in (tmp_path / "out/demo/package.xml").read_text()


class Shelf:
    """A resolver of `shelf://NAME`, and of a `local://` that it shadows."""

    def handles(self, ref: str) -> bool:
        return ref.startswith(("shelf://", "local://shadowed"))

    def resolve(self, ref: str, origin: Path) -> Path:
        name = ref.partition("://")[2]
        if name == "fails":
            raise KeyError(name)
        return origin.parent / ("part.nodl.yaml" if name != "gone" else "gone.nodl.yaml")


def test_resolvers(folder: Path) -> None:
    """The newest comes first, before those of ifgen, as in nodl_schema."""
    with resolvers.resolver_registered(Shelf()):
        for reference in ("shelf://part", "local://shadowed"):
            loaded = merged(folder, f"include: [{{ref: '{reference}'}}]")
            assert [endpoint.name for endpoint in loaded.whole.endpoints] == ["/part"]
        for reference, said in (("shelf://fails", "KeyError: 'fails'"), ("shelf://gone", "there is no file")):
            [error] = judge(folder, document(f"include: [{{ref: '{reference}'}}]")).errors
            assert said in error.message
            assert error.rule == "unknown-include"
    assert judge(folder, document("include: [{ref: 'shelf://part'}]")).errors


def test_an_installed_resolver(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = EntryPoint("shelf", f"{__name__}:Shelf", resolvers.GROUP)
    monkeypatch.setattr(resolvers, "_installed", lambda: (found.load()(),))
    assert merged(folder, "include: [{ref: 'shelf://part'}]").whole.endpoints


def test_what_is_no_resolver() -> None:
    with pytest.raises(TypeError, match="`handles` and `resolve`"):
        resolvers.register_resolver(5)  # type: ignore[arg-type]
    with pytest.raises(LookupError):
        resolvers.unregister_resolver(Shelf())
