"""What `ifgen doctor --graph` makes of what was seen."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from ifgen.cli.main import main
from ifgen.dynamic import TypeDescription
from ifgen_runtime.mismatch.reporting import definition_of
from ifgen_tools.doctor.definitions import User
from ifgen_tools.doctor.findings import Seen, findings

from tests.evolution.explaining.definitions import BATTERY, NEW, OLD, made

PLACE = "interfaces/robot_msgs/msg/BatteryState.msg"
OLDEST = "float32 voltage\n"


@pytest.fixture(autouse=True)
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that has the new version, and is the working directory."""
    (tmp_path / PLACE).parent.mkdir(parents=True)
    (tmp_path / PLACE).write_text(NEW)
    (tmp_path / "pyproject.toml").write_text('[tool.ifgen]\npaths = ["interfaces"]\n')
    monkeypatch.chdir(tmp_path)
    return tmp_path


def user(node: str, text: str, topic: str = "/battery", role: str = "publisher") -> User:
    return User(node, role, "topic", topic, topic, BATTERY, made(text).__type_hash__)


def seen(*users: User, sent: tuple[str, ...] = ()) -> Seen:
    """These users, of whom somebody has sent these definitions."""
    definitions: dict[str, TypeDescription] = {}
    for text in sent:
        own, type_hash = definition_of(made(text)), made(text).__type_hash__
        definitions[type_hash] = TypeDescription(BATTERY, type_hash, own.document, "/driver", own.sources)
    return Seen(tuple(each.node for each in users), users, definitions)


def told(found: Seen) -> list[tuple[str, str]]:
    """The rules, with the first lines of the messages."""
    return [(each.rule, each.message.partition("\n")[0]) for each in findings(found, [])]


TWO = ("type-mismatch", f"topic '/battery' has 2 definitions of {BATTERY}")
RENAMED = ("field-renamed", "robot_msgs/BatteryState.level was called `status`")
ADDED = ("field-added", "robot_msgs/BatteryState.current is new")


def test_the_projects_version_is_what_the_others_are_compared_with(project: Path) -> None:
    users = user("/driver", OLD), user("/spare", OLD), user("/monitor", NEW, role="subscription")
    assert told(seen(*users, sent=(OLD,))) == [TWO, RENAMED, ADDED]
    assert told(seen(*reversed(users), sent=(OLD,))) == [TWO, RENAMED, ADDED]
    (project / PLACE).write_text(OLD)
    assert main(["lock", "-q"]) == 0
    (project / PLACE).write_text(NEW)
    assert told(seen(*users)) == [TWO, RENAMED, ADDED]


def test_what_differs_is_told_once() -> None:
    found = told(
        seen(
            *(user("/driver", OLD), user("/monitor", NEW)),
            *(user("/driver", OLD, "/spare"), user("/monitor", NEW, "/spare")),
            sent=(OLD,),
        )
    )
    other = ("type-mismatch", f"topic '/spare' has 2 definitions of {BATTERY}")
    assert found == [TWO, RENAMED, ADDED, other]


def test_three_versions_are_one_disagreement() -> None:
    (mismatch, *changes) = findings(
        seen(user("/a", OLDEST), user("/b", OLD), user("/c", NEW), sent=(OLD,)), []
    )
    assert mismatch.message.partition("\n")[0] == f"topic '/battery' has 3 definitions of {BATTERY}"
    assert [change.rule for change in changes] == ["field-renamed", "field-added"]
    oldest, old = (made(text).__type_hash__[:23] for text in (OLDEST, OLD))
    assert mismatch.help == (
        f"what differs is unknown: no node sent the definition {oldest}..., and it is not installed. To see "
        "it, name the folder that has it with -I\n"
        "use one definition in all nodes, or convert with an adapter:\n"
        f"ifgen adapt {BATTERY} --from {oldest}\n"
        f"ifgen adapt {BATTERY} --from {old}"
    )


def test_a_node_that_lies_is_as_one_that_is_silent() -> None:
    found = seen(user("/driver", OLD), user("/monitor", NEW))
    lie, type_hash = definition_of(made(OLDEST)), made(OLD).__type_hash__
    definitions = {type_hash: TypeDescription(BATTERY, type_hash, lie.document, "/driver", lie.sources)}
    (mismatch,) = findings(Seen(found.nodes, found.users, definitions), [])
    assert (mismatch.help or "").startswith(
        "what differs is unknown: no node sent the definition RIHS01_3c76"
    )


def test_many_nodes_are_counted() -> None:
    (mismatch, *_) = findings(
        seen(*(user(f"/old{n}", OLD) for n in range(9)), user("/new", NEW), sent=(OLD,)), []
    )
    assert "/old4 (publisher), 4 more\n" in mismatch.message


def test_nodes_without_hashes_are_one_warning_that_can_be_ignored(project: Path) -> None:
    def without(node: str) -> User:
        return User(node, "publisher", "topic", "/battery", "/battery", BATTERY, "")

    found = seen(without("/camera"), without("/lidar"), user("/monitor", NEW))
    assert told(found) == [("no-type-hash", "the definitions of /camera, /lidar are not known")]
    settings: Any = (project / "pyproject.toml").open("a")
    with settings:
        settings.write('ignore = ["no-type-hash"]\n')
    assert told(found) == []
