"""The meaning of documents: both examples of the facts, every spelling of a value, and includes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from ifgen.nodl.model import Category, Parameter, ParameterType, QosProfile, Timer, Validator
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath

from .conftest import Load, load_from

EXAMPLES = Path(__file__).parent / "examples"
LATCHED = QosProfile("KEEP_LAST", "RELIABLE", 1, "TRANSIENT_LOCAL")
MINIMAL = "nodl_version: 2\n"


def including(*references: str) -> str:
    """A document that includes others."""
    return MINIMAL + "include:\n" + "".join(f"  - ref: {reference}\n" for reference in references)


def topic(name: str, category: str = "publishers") -> str:
    """A list with one topic."""
    return (
        f"{category}:\n  - name: {name}\n    type: std_msgs/String\n"
        "    qos: {history: KEEP_ALL, reliability: RELIABLE}\n"
    )


def test_gait_planner(load_nodes: Load) -> None:
    node = load_nodes((EXAMPLES / "gait_planner.nodl.yaml").read_text()).node
    assert (node.name, node.package, node.style, node.node_class) == (
        "talker",
        "demo",
        "asyncio",
        "GaitPlannerNode",
    )
    assert (node.business_file, node.tests) == ("gait_planner.py", ("contract", "actions", "parameters"))
    by_name = {parameter.name: parameter for parameter in node.parameters}
    assert next(iter(by_name)) == "step.length_max"
    assert by_name["step.length_max"] == Parameter(
        "step.length_max",
        ParameterType("double"),
        0.18,
        "Longest forward step [m]",
        validators=(Validator("bounds", (0.02, 0.30)),),
    )
    assert by_name["step.period_double_support"].validators == (Validator("gt_eq", (0.08,)),)
    assert by_name["first_leg"].validators == (Validator("one_of", ("left", "right")),)
    assert by_name["sole_polygon"].type == ParameterType("double", array=True, fixed_size=8)
    assert isinstance(by_name["sole_polygon"].default, tuple)
    assert by_name["stance_width"].read_only
    assert [(e.name, e.type_name, e.qos) for e in node.publishers] == [
        ("/footsteps/upcoming", "humanoid_interfaces/msg/FootstepPlan", LATCHED),
        ("~/markers", "visualization_msgs/msg/MarkerArray", LATCHED),
    ]
    assert [e.category for e in node.endpoints] == [
        *[Category.PUBLISHER] * 2,
        *[Category.SUBSCRIPTION] * 3,
        Category.SERVICE_CLIENT,
        Category.ACTION_SERVER,
    ]
    assert node.service_clients[0].qos is None


def test_whole_body_controller(tmp_path: Path) -> None:
    files = {f"demo/nodl/{path.name}": path.read_text() for path in EXAMPLES.iterdir()}
    loaded = load_from(tmp_path, files)
    assert loaded.nodes is not None
    [package] = loaded.nodes.packages
    assert [node.name for node in package.nodes] == ["gait_planner", "whole_body_controller"]  # no fragment
    node = package.nodes[1]
    assert node.timers == (Timer("control", period_parameter="control.period"),)
    joints = next(parameter for parameter in node.parameters if parameter.name == "joints")
    function = "whole_body_controller.checks.odd_joint_count"
    assert joints == Parameter(
        "joints",
        ParameterType("string", array=True),
        None,
        "Joint names in command order; must be given at start",
        True,
        validators=(
            Validator("not_empty"),
            Validator("unique"),
            Validator("humanoid_checks::odd_joint_count", (), function),
        ),
    )
    assert [e.name for e in node.subscriptions][-1] == "/imu/data"
    assert node.service_servers[1].qos == QosProfile("KEEP_LAST", "RELIABLE", 10)
    assert {source.path.name for source in package.sources} == {path.name for path in EXAMPLES.iterdir()}
    registry = loaded.nodes.registry
    assert registry.interface("humanoid_interfaces/action/WalkTo")
    assert registry.message("geometry_msgs/msg/Vector3")  # it also contains what they need


def test_json_says_the_same_as_yaml(load_nodes: Load) -> None:
    import yaml

    text = (EXAMPLES / "gait_planner.nodl.yaml").read_text()
    from_yaml = load_nodes(text).node
    assert from_yaml.path is not None
    from_yaml.path.unlink()
    as_json = json.dumps(yaml.safe_load(text), indent="\t", ensure_ascii=True)
    assert load_nodes({"demo/nodl/talker.nodl.json": as_json}).node == from_yaml


@pytest.mark.parametrize(
    ("text", "rule", "at"),
    [
        ("", "empty-document", (1, 1)),
        ('{"nodl_version": 2,}', "json-syntax", (1, 20)),
        ('{"nodl_version" 2}', "json-syntax", (1, 17)),
        ("{nodl_version: 2}", "json-syntax", (1, 2)),
        ('{"nodl_version": 2', "json-syntax", (1, 19)),
        ('{"nodl_version": 02}', "json-syntax", (1, 19)),
        ('{"nodl_version": 2} x', "json-syntax", (1, 21)),
        ('{"nodl_version": 2, "description": "a\nb"}', "json-syntax", (1, 38)),
        ('{"nodl_version": 2, "description": "\\x"}', "json-syntax", (1, 37)),
        ('{"nodl_version": 2, "nodl_version": 2}', "duplicate-key", (1, 21)),
        ('{"nodl_version": 2, "description": "\\ud800"}', "invalid-text", (1, 36)),
        ('{"nodl_version": NaN}', "json-syntax", (1, 18)),
        ("[" * 100, "too-large", (1, 41)),
    ],
)
def test_json_mistakes(load_nodes: Load, text: str, rule: str, at: tuple[int, int]) -> None:
    [found] = load_nodes({"demo/nodl/talker.nodl.json": text}).diagnostics
    assert found.primary is not None
    assert (found.rule, (found.primary.span.line, found.primary.span.column)) == (rule, at)


def test_aliases_and_merge_keys(load_nodes: Load) -> None:
    """One profile for several endpoints; keys next to `<<` win."""
    node = load_nodes(
        MINIMAL
        + """
codegen:
  shared:
    qos: &latched {history: KEEP_LAST, depth: 1, reliability: RELIABLE, durability: TRANSIENT_LOCAL}
publishers:
  - {name: a, type: std_msgs/String, qos: *latched}
  - {name: b, type: std_msgs/String, qos: {<<: *latched, depth: 5}}
  - {name: c, type: std_msgs/String, qos: {depth: 6, <<: [{reliability: BEST_EFFORT}, *latched]}}
"""
    ).node
    assert [e.qos for e in node.publishers] == [
        LATCHED,
        QosProfile("KEEP_LAST", "RELIABLE", 5, "TRANSIENT_LOCAL"),
        QosProfile("KEEP_LAST", "BEST_EFFORT", 6, "TRANSIENT_LOCAL"),
    ]


def test_values_of_every_type(load_nodes: Load) -> None:
    node = load_nodes(
        MINIMAL
        + """parameters:
  a: {type: bool, default_value: yes}
  b: {type: int, default_value: 0x10, validation: {bounds: [0.0, 32]}}
  c: {type: double, default_value: 1}
  d: {type: double, default_value: -.inf}
  e: {type: string, default_value: "on", validation: {'my::check': [1, two, true]}}
  f: {type: none}
  g: {type: bool_array, default_value: [true, off]}
  h: {type: double_array, default_value: [1, 2.5e+0]}
  i: {type: byte_array, default_value: [0, 255]}
  j: {type: string_array, default_value: []}
  k: {type: string_fixed_4, default_value: four, validation: {'my::check<>': }}
codegen: {ifgen: {validators: {'my::check': my.checks.check}}}
""".replace("{'my::check<>': }", "{fixed_size: 4.0}")
    ).node
    assert [parameter.default for parameter in node.parameters] == [
        True, 16, 1.0, float("-inf"), "on", None, (True, False), (1.0, 2.5), b"\x00\xff", (), "four",
    ]  # fmt: skip
    assert node.parameters[1].validators[0].arguments == (0, 32)
    assert all(type(argument) is int for argument in node.parameters[1].validators[0].arguments)
    assert node.parameters[4].validators == (Validator("my::check", (1, "two", True), "my.checks.check"),)


def test_timers(load_nodes: Load) -> None:
    node = load_nodes(
        MINIMAL
        + topic("/a")
        + "parameters: {dt: {type: double, default_value: 0.5}}\n"
        + """codegen:
  ifgen:
    timers:
      - {name: fast, rate: 100, publishes: [/a]}
      - {name: slow, period: 2, clock: steady}
      - {name: free, period_param: dt}
"""
    ).node
    assert node.timers == (
        Timer("fast", 0.01, publishes=("/a",)),
        Timer("slow", 2.0, clock="steady"),
        Timer("free", period_parameter="dt"),
    )


def test_include_is_recursive_and_breadth_first(load_nodes: Load) -> None:
    loaded = load_nodes(
        {
            "demo/nodl/talker.nodl.yaml": including("local://parts/b.nodl.yaml", "nodl://other/c")
            + topic("a"),
            "demo/nodl/parts/b.nodl.yaml": including("local://../parts/d.nodl.json") + topic("b"),
            "demo/nodl/parts/d.nodl.json": '{"nodl_version": 2, "description": "lost", "codegen": {"ifgen": {"style": "asyncio"}}}',
            "other/nodl/c.nodl.yml": MINIMAL + topic("c") + topic("a", "subscriptions"),
        }
    )
    assert loaded.nodes is not None
    [demo, other] = loaded.nodes.packages
    assert [(e.category.value, e.name) for e in demo.nodes[0].endpoints] == [
        ("publishers", "a"),
        ("publishers", "b"),
        ("publishers", "c"),
        ("subscriptions", "a"),
    ]
    assert demo.nodes[0].style == "callbacks"
    assert demo.nodes[0].description == ""
    assert [node.name for node in other.nodes] == ["c"]  # although included, still a node
    assert len(demo.sources) == 4


def test_the_ament_index(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An installed document is found by `nodl://`, in the index and in the package's share folder."""
    index = "prefix/share/ament_index/resource_index/nodl/robot__arm"
    installed = {
        index: MINIMAL + topic("arm"),
        "prefix/share/robot/nodl/leg.nodl.yaml": MINIMAL + topic("leg"),
    }
    load_from(tmp_path, {**installed, "prefix/COLCON_IGNORE": "", "x/msg/A.msg": ""})
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "prefix"))
    loaded = load_from(tmp_path, {"demo/nodl/n.nodl.yaml": including("nodl://robot/arm", "nodl://robot/leg")})
    assert [e.name for e in loaded.node.publishers] == ["arm", "leg"]


def test_cycles_and_diamonds_show_both_ways(load_nodes: Load) -> None:
    cycle = load_nodes(
        {
            "demo/nodl/talker.nodl.yaml": including("local://a.nodl.yaml"),
            "demo/nodl/a.nodl.yaml": including("local://b.nodl.yaml"),
            "demo/nodl/b.nodl.yaml": including("local://talker.nodl.yaml"),
        }
    )
    # In a ring each is a part of another; the first one counts as the node.
    assert cycle.rules == ["included-twice"]
    diamond = load_nodes(
        {
            "demo/nodl/talker.nodl.yaml": including("local://a.nodl.yaml", "local://b.nodl.yaml"),
            "demo/nodl/a.nodl.yaml": including("local://c.nodl.yaml"),
            "demo/nodl/b.nodl.yaml": including("nodl://demo/c"),
            "demo/nodl/c.nodl.yaml": MINIMAL,
        }
    )
    [found] = diamond.diagnostics
    assert found.rule == "included-twice"
    assert found.help is not None
    assert "talker.nodl.yaml > local://a.nodl.yaml > local://c.nodl.yaml" in found.help
    assert "talker.nodl.yaml > local://b.nodl.yaml > nodl://demo/c" in found.help
    assert found.secondary[0].span.source.path.name == "a.nodl.yaml"


def test_one_name_in_two_documents(load_nodes: Load) -> None:
    part = MINIMAL + topic("a") + "parameters: {p: {type: int}}\n"
    loaded = load_nodes(
        {
            "demo/nodl/talker.nodl.yaml": including("local://x.nodl.yaml") + part.removeprefix(MINIMAL),
            "demo/nodl/x.nodl.yaml": part,
        }
    )
    assert sorted(loaded.rules) == ["duplicate-endpoint", "duplicate-parameter"]
    for found in loaded.diagnostics:
        assert found.primary is not None
        assert found.primary.span.source.path.name == "x.nodl.yaml"
        assert found.secondary[0].span.source.path.name == "talker.nodl.yaml"


def test_a_mistake_in_a_part_is_told_once(load_nodes: Load) -> None:
    part = MINIMAL + topic("a").replace("String", "Strin")
    loaded = load_nodes(
        {
            "demo/nodl/a.nodl.yaml": including("local://x.nodl.yaml"),
            "demo/nodl/b.nodl.yaml": including("local://x.nodl.yaml"),
            "demo/nodl/x.nodl.yaml": part,
        }
    )
    assert loaded.rules == ["unknown-type"]


def test_a_part_with_options_is_a_node_too(load_nodes: Load) -> None:
    loaded = load_nodes(
        {
            "demo/nodl/a.nodl.yaml": including("local://x.nodl.yaml"),
            "demo/nodl/x.nodl.yaml": MINIMAL + "codegen: {ifgen: {}}\n",
        }
    )
    assert loaded.nodes is not None
    assert [node.name for node in loaded.nodes.packages[0].nodes] == ["a", "x"]


def test_names_of_nodes_and_packages(load_nodes: Load) -> None:
    bad = load_nodes(
        {
            "demo/nodl/gait-planner.nodl.yaml": MINIMAL,
            "demo/nodl/import.nodl.yaml": MINIMAL,
            "demo/nodl/a.nodl.yaml": MINIMAL,
            "demo/nodl/a.nodl.json": '{"nodl_version": 2}',
            "Demo-2/nodl/a.nodl.yaml": MINIMAL,
        }
    )
    rules = ["duplicate-node", "invalid-node-name", "invalid-node-name", "invalid-package-name"]
    assert sorted(set(bad.rules)) == sorted(set(rules))
    assert any("did you mean `gait_planner`" in (found.help or "") for found in bad.diagnostics)


def test_classes_are_named_after_nodes(load_nodes: Load) -> None:
    names = {"gait_planner": "GaitPlanner", "GPSDriver": "GPSDriver", "_a1_b": "A1B", "x": "X"}
    loaded = load_nodes({f"demo/nodl/{name}.nodl.yaml": MINIMAL for name in names})
    assert loaded.nodes is not None
    assert {node.name: node.node_class for node in loaded.nodes.packages[0].nodes} == names


def test_package_xml(load_nodes: Load) -> None:
    xml = """<package format="3"><name>robot</name><version>1.2.3</version>
<description>A  <b>robot</b>
</description><maintainer email=" a@b.c ">A. B.</maintainer><maintainer email="d">D</maintainer>
<license>MIT</license></package>"""
    loaded = load_nodes(
        {"some/package.xml": xml, "some/nodl/n.nodl.yaml": MINIMAL, "b/nodl/n.nodl.yaml": MINIMAL}
    )
    assert loaded.nodes is not None
    [b, robot] = loaded.nodes.packages
    assert (b.metadata, robot.name) == (None, "robot")
    found = robot.metadata
    assert found is not None
    assert (found.version, found.description, found.license) == ("1.2.3", "A robot", "MIT")
    assert (found.maintainer_name, found.maintainer_email) == ("A. B.", "a@b.c")


def test_nodes_of_a_package_that_never_meet(load_nodes: Load) -> None:
    """One warning each, with both places; policies that the middleware decides are not mistakes."""
    listener = topic("/talker/a", "subscriptions").replace(
        "RELIABLE", "RELIABLE, durability: TRANSIENT_LOCAL"
    )
    loaded = load_nodes(
        {
            "demo/nodl/talker.nodl.yaml": MINIMAL + topic("~/a"),
            "demo/nodl/listener.nodl.yaml": MINIMAL + listener,
            "demo/nodl/other.nodl.yaml": MINIMAL
            + topic("/talker/a", "subscriptions").replace("String", "Bool"),
            "demo/nodl/lucky.nodl.yaml": MINIMAL + listener.replace("TRANSIENT_LOCAL", "SYSTEM_DEFAULT"),
        }
    )
    assert loaded.nodes is not None
    assert loaded.rules == ["never-meet"] * 2
    assert all(found.severity == "warning" for found in loaded.diagnostics)


def test_single_files_and_folders(tmp_path: Path) -> None:
    """A file denotes its package with only that node; its folder denotes the package with all nodes."""
    load_from(
        tmp_path, {"demo/nodl/a.nodl.yaml": MINIMAL, "demo/nodl/b.nodl.json": "{}", "demo/msg/A.msg": ""}
    )

    def names(path: Path) -> list[tuple[str, list[str], int]]:
        return [(p.name, [node.name for node in p.nodes], len(p.files)) for p in find_packages([path])]

    assert names(tmp_path) == names(tmp_path / "demo") == [("demo", ["a", "b"], 1)]
    assert names(tmp_path / "demo/nodl") == [("demo", ["a", "b"], 0)]
    assert names(tmp_path / "demo/nodl/a.nodl.yaml") == [("demo", ["a"], 0)]
    [package] = find_packages([tmp_path / "demo/nodl/a.nodl.yaml"])
    assert [node.name for node in package.known_nodes()] == ["a", "b"]
    search = SearchPath([package])
    found = search.find_node("demo", "b")
    assert found is not None
    assert found.path.name == "b.nodl.json"


def test_maps_of_structs_are_expanded(load_nodes: Load) -> None:
    node = load_nodes(
        "nodl_version: 2\ncodegen: {ifgen: {structs: {gains: {each: joints, of: {p: {type: double}}}, "
        "limits: {each: [hip], of: {max: {type: int, default_value: 3}}}}}}\n"
        "parameters: {joints: {type: string_array, default_value: [hip, knee]}}\n"
    ).node
    expected = ["joints", "gains.hip.p", "gains.knee.p", "limits.hip.max"]
    assert [parameter.name for parameter in node.parameters] == expected
    assert node.parameters[3].default == 3
