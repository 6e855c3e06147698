"""`--system` of check, graph, breaking and launch, as one types them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from ifgen import resources
from ifgen_tools.system import manifest
from ifgen_tools.system.changes import changes

from tests.cli.conftest import Run, cache_folder, clean_environment, ifgen

from . import systems

__all__ = ["cache_folder", "clean_environment", "ifgen"]

LAUNCH = "crab_base/launch/crab.launch.xml"
WORDS = ("check", "--system", LAUNCH, "crab_base")


@pytest.fixture(autouse=True)
def base(clean_environment: None) -> None:
    systems.write(systems.BASE, Path())


def edit(name: str, old: str, new: str) -> None:
    path = Path(name)
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new, 1))


def test_a_typo_in_a_remap_has_carets_in_each_file(ifgen: Run) -> None:
    edit(LAUNCH, 'from="output"', 'from="ouput"')
    done = ifgen(*WORDS)
    assert done.code == 1
    assert done.out.startswith(
        """error[system-unused-remap]: /crab/mux has no name `ouput`, which is renamed to `drive`
  --> crab_base/launch/crab.launch.xml:10:20
   |
10 |       <remap from="ouput" to="drive"/>
   |                    ^^^^^
  ::: crab_base/nodl/mux.nodl.yaml:6:12
   |
 6 |   - {name: output, type: geometry_msgs/Twist, qos: {history: KEEP_LAST, d…
   |            ------ not this?
   = help: did you mean `output`?
"""
    )


def test_formats_arguments_and_parameter_files(ifgen: Run) -> None:
    Path("more.yaml").write_text("/**/driver: {ros__parameters: {port: 7}}\n")
    done = ifgen(*WORDS, "wander:=false", "--params", "more.yaml", "--format", "json")
    (found,) = json.loads(done.out)["diagnostics"]
    assert (found["rule"], len(found["labels"])) == ("system-value-type", 2)
    assert ifgen(*WORDS, "more.yaml", "--format", "github").out.startswith("::error file=more.yaml,line=1")
    assert ifgen(*WORDS).out == "7 nodes, 8 connections: no mistakes\n"
    # Its own parameters are those of /crab.
    done = ifgen(*WORDS, "robot:=other")
    assert "warning[system-no-receiver]" in done.out
    assert "error[system-no-value]" in done.out


def test_warnings_are_silenced_by_comments_and_by_the_configuration(ifgen: Run) -> None:
    edit("crab_base/nodl/wander.nodl.yaml", "2.0..3", "'2.4'")
    assert "warning[system-version]" in ifgen(*WORDS).out
    assert ifgen(*WORDS, "--strict").code == 1
    Path("pyproject.toml").write_text('[tool.ifgen]\nignore = ["system-version"]\n')
    assert ifgen(*WORDS).out.endswith(": no mistakes\n")
    Path("pyproject.toml").write_text("")
    edit("crab_base/nodl/wander.nodl.yaml", "codegen:", "# ifgen: ignore[system-version]\ncodegen:")
    assert ifgen(*WORDS).out.endswith(": no mistakes\n")
    # Only a look at the whole system can tell whether that is of use.
    assert "unused-ignore" not in ifgen("check", "crab_base").out


def test_an_open_end_is_a_mistake_only_if_all_must_be_described(ifgen: Run) -> None:
    Path("crab_base/nodl/sonar.nodl.yaml").unlink()
    edit("crab_base/nodl/wander.nodl.yaml", ", ranges: {required: true}", "")
    assert ifgen(*WORDS).out == "7 nodes, 8 connections, 1 open end: no mistakes\n"
    done = ifgen(*WORDS, "--complete")
    assert "error[system-no-document]: nothing describes /crab/sonar: crab_base/sonar" in done.out


def test_a_package_of_elsewhere_is_an_open_end(ifgen: Run) -> None:
    edit(LAUNCH, 'pkg="crab_base" exec="sonar"', 'pkg="nav2_unknown" exec="sonar"')
    edit("crab_base/nodl/wander.nodl.yaml", ", ranges: {required: true}", "")
    assert ifgen(*WORDS).out == "7 nodes, 8 connections, 1 open end: no mistakes\n"


def test_options_without_a_system_or_a_launch_file(ifgen: Run) -> None:
    assert "need --system" in ifgen("check", "crab_base", "--complete").err
    assert "needs a launch file" in ifgen("check", "--system", "crab_base").err
    assert "need --system" in ifgen("graph", "crab_base", "--lock").err
    assert ifgen("breaking", "crab_base").code == 2
    assert "OLD and NEW" in ifgen("breaking", "--system", "crab_base").err


def test_it_is_drawn_after_renaming(ifgen: Run) -> None:
    done = ifgen("graph", "--system", LAUNCH, "crab_base", "--no-python")
    assert "/crab/sonar/ranges" in done.out
    assert done.code == 0
    assert ifgen("graph", "--system", LAUNCH, "crab_base", "-o", "graph.svg").code == 0
    # `ifgen graph --system` draws the picture of docs/contract.md so.
    assert Path("graph.svg").read_text() == (resources.rules_page().parent / "contract.svg").read_text()


def test_launch_says_it_before_it_starts_anything(ifgen: Run) -> None:
    edit(LAUNCH, 'exec="power"', 'exec="pwoer"')
    Path("pyproject.toml").write_text('[tool.ifgen]\npaths = ["crab_base"]\n')
    done = ifgen("launch", "--check", LAUNCH)
    assert "error[system-no-executable]" in done.out
    assert "did you mean 'power'?" in done.out
    assert done.code == 1


def test_two_manifests_are_compared(ifgen: Run) -> None:
    assert ifgen(*WORDS, "--lock").err == "wrote ifgen.system.lock\n"
    Path("ifgen.system.lock").rename("old.lock")
    edit("crab_base/nodl/driver.nodl.yaml", "name: battery", "name: charge")
    edit("crab_base/nodl/driver.nodl.yaml", "version: 2.1.0", "version: 2.2.0")
    edit("crab_base/nodl/power.nodl.yaml", "name: battery", "name: charge")
    edit("crab_base/nodl/sonar.nodl.yaml", "depth: 5", "depth: 7")
    assert ifgen(*WORDS, "--lock").code == 0
    done = ifgen("breaking", "--system", "old.lock", "ifgen.system.lock")
    assert done.code == 1
    assert done.out.splitlines() == [
        "major  provided topic /crab/battery: gone, of /crab/driver",
        "minor  provided topic /crab/charge: new, of /crab/driver",
        "minor  provided topic /crab/odom: version 2.2.0, was 2.1.0",
        "minor  required topic /crab/charge: new, of /crab/power",
        "patch  provided topic /crab/sonar/ranges: QoS of /crab/sonar: depth 5 -> 7",
        "patch  required topic /crab/battery: gone, of /crab/power",
        "major: 1 major, 3 minor, 2 patch",
    ]
    found = json.loads(ifgen("breaking", "--system", "old.lock", "ifgen.system.lock", "--format", "json").out)
    assert (found["errors"], found["warnings"]) == (1, 5)
    assert ifgen("breaking", "--system", "old.lock", "old.lock").out == "nothing changed\n"


@pytest.mark.parametrize(
    ("category", "before", "after", "level"),
    [
        ("publishers", "RELIABLE", "BEST_EFFORT", "major"),
        ("publishers", "BEST_EFFORT", "RELIABLE", "minor"),
        ("subscriptions", "RELIABLE", "BEST_EFFORT", "patch"),
        ("subscriptions", "BEST_EFFORT", "RELIABLE", "major"),
    ],
)
def test_the_qos_of_a_provided_and_of_a_required_topic(
    category: str, before: str, after: str, level: str
) -> None:
    def content(reliability: str) -> manifest.Manifest:
        qos = {"history": "KEEP_LAST", "depth": 1, "reliability": reliability}
        end = {"category": category, "name": "/x", "type": "std_msgs/msg/String", "qos": qos}
        node = {"package": "p", "executable": "a", "endpoints": [end]}
        path = Path("some.lock")
        path.write_text(json.dumps({"version": 1, "open_ends": [], "nodes": {"/a": node}}))
        return manifest.read(path)

    (found,) = changes(content(before), content(after))
    assert found.level == level


def test_a_type_that_changes_is_major_on_both_sides(ifgen: Run) -> None:
    assert ifgen(*WORDS, "--lock").code == 0
    old = manifest.read(Path("ifgen.system.lock"))
    edit("ifgen.system.lock", "RIHS01_", "RIHS01_0")
    (found,) = changes(old, manifest.read(Path("ifgen.system.lock")))
    assert (found.level, found.what[:21]) == ("major", "another definition of")
