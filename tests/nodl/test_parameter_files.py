"""Parameter files against declarations. `⟦...⟧` marks what the caret must point at."""

from __future__ import annotations

from pathlib import Path

import pytest
from ifgen.nodl.parameter_files import check, is_parameter_file

from .conftest import Load

DOCUMENT = """nodl_version: 2
parameters:
  rate: {type: double, default_value: 1.0, validation: {gt: 0.0}}
  names: {type: string_array, validation: {not_empty: }}
  colour.r: {type: int, default_value: 5, validation: {bounds: [0, 255]}}
  label: {type: string_fixed_3, default_value: abc}
  on: {type: bool, default_value: true}
""".replace("  on:", '  "on":')


def section(text: str, name: str = "talker") -> str:
    return f"{name}:\n  ros__parameters: {{{text}}}\n"


GOOD = [
    section("rate: 2.5, names: [a], colour: {r: 7}"),
    section("rate: 1e3, names: ['1'], 'on': yes"),
    section("names: [a], colour.r: 0", "/robot/talker"),
    section("names: [a], use_sim_time: true", "/**/talker"),
    section("names: [a], qos_overrides: {/a: {depth: 5}}", "/**"),
    "robot:\n  talker:\n    ros__parameters: {names: [a]}\n",
    section("names: [a]") + section("rate: 3.0", "/**"),
    section("names: [a]", "/*"),
    section("names: [a]", "'*'"),
    section("names: [a]", "/robot/*"),
    section("names: [a]", "/**/arm/talker"),
]
BAD = [
    ("unknown-parameter", section("names: [a], ⟦rat⟧: 2.0"), "did you mean `rate`"),
    ("unknown-parameter", section("names: [a], colour: {⟦g⟧: 2}"), "`colour.g`"),
    ("wrong-value", section("names: [a], rate: ⟦10⟧"), "decimal point"),
    ("wrong-value", section("names: [a], rate: ⟦fast⟧"), "a number"),
    ("wrong-value", section("names: ⟦a⟧"), "a list"),
    ("wrong-value", section("names: [⟦5⟧]"), "a text"),
    ("wrong-value", section("names: [a], label: ⟦abcd⟧"), "at most 3"),
    ("wrong-value", section("names: [a], 'on': ⟦1⟧"), "true or false"),
    ("rejected-value", section("names: [a], rate: ⟦-1.0⟧"), "gt 0.0"),
    ("rejected-value", section("names: ⟦[]⟧"), "not_empty"),
    ("rejected-value", section("names: [a], colour.r: ⟦256⟧"), "bounds 0, 255"),
    ("missing-value", section("rate: 2.0").replace("talker", "⟦⟧talker", 1), "`names`"),
    ("unknown-node", section("names: [a]", "⟦talkr⟧"), "did you mean `talker`"),
    ("unknown-node", "⟦⟧# nothing\n", "sets no parameters"),
    ("wrong-value", "talker: ⟦5⟧\n", "ros__parameters"),
    ("wrong-value", "talker:\n  ros__parameters: ⟦[a]⟧\n", "ros__parameters"),
    ("unknown-key", "talker:\n  ⟦ros_parameters⟧: {rate: 2.0}\n", "two underscores"),
    ("unknown-key", "/**:\n  ⟦ros__parameter⟧: {rate: 2.0}\n", "two underscores"),
    ("unknown-parameter", section("names: [a], ⟦rat⟧: 2.0", "/**"), "did you mean `rate`"),
    ("wrong-value", section("names: [a], rate: ⟦10⟧", "/*/talker"), "decimal point"),
    ("wrong-value", "robot:\n  arm:\n    talker:\n      ros__parameters: {rate: ⟦yes⟧}\n", "a number"),
    ("yaml-syntax", "talker: [⟦\n⟧", "not YAML"),
]


@pytest.mark.parametrize("text", GOOD)
def test_what_the_node_accepts(load_nodes: Load, tmp_path: Path, text: str) -> None:
    file = tmp_path / "params.yaml"
    file.write_text(text)
    assert [found.message for found in check([file], [load_nodes(DOCUMENT).node])] == []


@pytest.mark.parametrize(("rule", "text", "said"), BAD)
def test_what_it_refuses(load_nodes: Load, tmp_path: Path, rule: str, text: str, said: str) -> None:
    start, end = text.index("⟦"), text.index("⟧") - 1
    file = tmp_path / "params.yaml"
    file.write_text(text.replace("⟦", "").replace("⟧", ""))
    found = check([file], [load_nodes(DOCUMENT).node])[0]
    assert (found.rule, said in f"{found.message} {found.help}") == (rule, True), (found.message, found.help)
    assert found.primary is not None
    assert (found.primary.span.start, found.primary.span.end) == (start, end)


def test_which_files_are_parameter_files(tmp_path: Path) -> None:
    for name in ("a.yaml", "b.yml", "c.nodl.yaml", "d.msg"):
        (tmp_path / name).touch()
    found = [path.name for path in sorted(tmp_path.iterdir()) if is_parameter_file(path)]
    assert found == ["a.yaml", "b.yml"]
