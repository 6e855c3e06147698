"""The text of a warning about two nodes whose definitions of a type differ."""

from __future__ import annotations

import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import ifgen
import pytest
from ifgen.cli.evolution.explain import explain
from ifgen.cli.main import main
from ifgen.evolution.explaining.definitions import Installed, of_sources
from ifgen.evolution.explaining.explanation import differences
from ifgen_runtime.mismatch.reporting import Definition

from .definitions import BATTERY, NEW, OLD, made, met, without_definition, without_sources

PLACE = "interfaces/robot_msgs/msg/BatteryState.msg"
UNKNOWN = "what differs is unknown: /driver did not send its definition, and none with this"


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that has the new version, and is the working directory."""
    (tmp_path / PLACE).parent.mkdir(parents=True)
    (tmp_path / PLACE).write_text(NEW)
    (tmp_path / "pyproject.toml").write_text('[tool.ifgen]\npaths = ["interfaces"]\n')
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("ifgen.evolution.explaining.explanation._PATIENCE", 60.0)  # machines may be busy
    return tmp_path


def test_the_whole_text(project: Path) -> None:
    assert (
        explain(asdict(met(made(OLD), made(NEW))))
        == """\
topic '/battery': /driver (publisher) has another definition of
robot_msgs/msg/BatteryState than /monitor (subscription):
RIHS01_3c76ee04b5060378..., not RIHS01_a24211bdc350d117...

From that definition to this one:

warning[field-renamed]: robot_msgs/BatteryState.level was called `status`
 --> interfaces/robot_msgs/msg/BatteryState.msg:9:7
  |
9 | uint8 level          # one of the constants
  |       ^^^^^
 ::: /driver:robot_msgs/msg/BatteryState.msg:7:7
  |
7 | uint8 status         # OK or LOW
  |       ------ before
  = help: this breaks source and hash

warning[field-added]: robot_msgs/BatteryState.current is new
 --> interfaces/robot_msgs/msg/BatteryState.msg:7:9
  |
7 | float32 current      # [A]
  |         ^^^^^^^ this field
  = help: this breaks hash and wire

on_type_mismatch is warn: messages still flow as far as ROS lets them, and may
be garbage
help: use the same definition in both nodes. Until then, an adapter can convert:
      ifgen adapt robot_msgs/msg/BatteryState --from RIHS01_3c76ee04b5060378
      and set on_type_mismatch to adapt"""
    )


def test_a_definition_that_is_in_no_file_is_shown_by_the_name_of_its_type(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert " --> robot_msgs/msg/BatteryState.msg:7:9\n" in explain(asdict(met(made(OLD), made(NEW))))


def test_a_file_with_another_text_is_not_the_place(project: Path) -> None:
    (project / PLACE).write_text(f"# Moved\n{NEW}")
    assert " --> robot_msgs/msg/BatteryState.msg:7:9\n" in explain(asdict(met(made(OLD), made(NEW))))


def test_a_nested_field_is_shown_with_its_path(project: Path) -> None:
    state = "string name\ngeometry_msgs/PoseWithCovariance pose\nBatteryState[<=4] batteries\n"
    name = "robot_msgs/msg/State"
    theirs, mine = (made(state, name, {BATTERY: text}) for text in (OLD, NEW))
    text = explain(asdict(met(theirs, mine)))
    assert "warning[field-added]: robot_msgs/State.batteries.current is new\n" in text
    assert "3 | BatteryState[<=4] batteries\n  |                   ^^^^^^^^^ through this field\n" in text
    assert f" ::: {PLACE}:7:9\n" in text


def test_a_description_without_sources_shows_the_local_definition_only(project: Path) -> None:
    mismatch = met(made(OLD), made(NEW))
    text = explain(asdict(replace(mismatch, theirs=without_sources(mismatch.theirs))))
    assert f" --> {PLACE}:9:7\n" in text
    assert ":::" not in text
    assert "EMPTY" not in text  # a description has no constants, so none of them is new


def test_a_class_that_knows_no_source_is_found_in_the_file_with_its_hash(project: Path) -> None:
    mismatch = met(made(OLD), made(NEW))
    text = explain(asdict(replace(mismatch, mine=without_sources(mismatch.mine))))
    assert f" --> {PLACE}:9:7\n" in text
    mine = replace(mismatch.mine, definition=None)
    assert f" --> {PLACE}:9:7\n" in explain(asdict(replace(mismatch, mine=mine)))


def _in_an_include_folder(folder: Path) -> None:
    file = folder / "released" / "robot_msgs" / "msg" / "BatteryState.msg"
    file.parent.mkdir(parents=True)
    file.write_text(OLD)
    (folder / "pyproject.toml").write_text('[tool.ifgen]\npaths = ["interfaces"]\ninclude = ["released"]\n')


def _in_the_lock_file(folder: Path) -> None:
    (folder / PLACE).write_text(OLD)
    assert main(["lock", "-q"]) == 0
    (folder / PLACE).write_text(NEW)


def _in_the_ament_index(folder: Path) -> None:
    file = folder / "opt" / "share" / "robot_msgs" / "msg" / "BatteryState.msg"
    file.parent.mkdir(parents=True)
    file.write_text(OLD)
    pytest.MonkeyPatch().setenv("AMENT_PREFIX_PATH", str(folder / "opt"))


def _in_a_generated_package(folder: Path) -> None:
    source = folder / "old" / "robot_msgs" / "msg" / "BatteryState.msg"
    source.parent.mkdir(parents=True)
    source.write_text(OLD)
    ifgen.generate(source.parents[1], output=folder / "elsewhere")
    source.unlink()
    sys.path.append(str(folder / "elsewhere"))


@pytest.mark.parametrize(
    ("install", "place"),
    [
        (_in_an_include_folder, "released/robot_msgs/msg/BatteryState.msg:7:7"),
        (_in_the_lock_file, "ifgen.lock:"),
        (_in_the_ament_index, "opt/share/robot_msgs/msg/BatteryState.msg:7:7"),
        (_in_a_generated_package, "elsewhere:robot_msgs/msg/BatteryState.msg:7:7"),
    ],
)
def test_a_definition_that_was_not_sent_may_be_installed(
    install: Any, place: str, project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.setenv("AMENT_PREFIX_PATH", "")  # set back at the end, whoever sets it
    mismatch = without_definition(met(made(OLD), made(NEW)))
    assert UNKNOWN in explain(mismatch)
    install(project)
    text = explain(mismatch)
    assert UNKNOWN not in text
    assert "warning[field-renamed]: robot_msgs/BatteryState.level was called `status`\n" in text
    assert f" ::: {place}" in text


def test_a_definition_that_nobody_has_leaves_a_warning_that_says_how_to_get_it(project: Path) -> None:
    assert (
        explain(without_definition(met(made(OLD), made(NEW), policy="refuse")))
        == """\
topic '/battery': /driver (publisher) has another definition of
robot_msgs/msg/BatteryState than /monitor (subscription):
RIHS01_3c76ee04b5060378..., not RIHS01_a24211bdc350d117...

what differs is unknown: /driver did not send its definition, and none with this
hash is installed. To see it, name the folder that has it in `include` of
[tool.ifgen], or put the package that was generated from it on PYTHONPATH
on_type_mismatch is refuse: nothing from '/battery' reaches /monitor while
/driver publishes there
help: use the same definition in both nodes. Until then, an adapter can convert:
      ifgen adapt robot_msgs/msg/BatteryState --from RIHS01_3c76ee04b5060378
      and set on_type_mismatch to adapt"""
    )


def test_a_lie_is_one_sentence(project: Path) -> None:
    mismatch = met(made(OLD), made(NEW))
    lie = replace(mismatch.theirs, definition=mismatch.mine.definition)
    text = explain(asdict(replace(mismatch, theirs=lie)))
    assert "what differs is unknown: /driver says what does not fit its hash, and none with" in text


def test_sources_that_lie_do_not_count_if_the_description_fits(project: Path) -> None:
    mismatch = met(made(OLD), made(NEW))
    assert mismatch.theirs.definition is not None
    lie = Definition(mismatch.theirs.definition.document, ((BATTERY, "msg", "int8 x"),))
    text = explain(asdict(replace(mismatch, theirs=replace(mismatch.theirs, definition=lie))))
    assert "robot_msgs/BatteryState.level was called `status`" in text


@pytest.mark.parametrize(
    ("name", "old", "new", "said"),
    [
        (
            "robot_msgs/srv/SetMode",
            "uint8 mode\n---\nbool success\n",
            "uint16 mode\n---\nbool success\n",
            "warning[field-type]: robot_msgs/srv/SetMode_Request.mode was `uint8`, and is\n  `uint16`\n",
        ),
        (
            "robot_msgs/action/Walk",
            "geometry_msgs/Point to\n---\nbool success\n---\nfloat32 left\n",
            "geometry_msgs/Point to\n---\nbool success\n---\nfloat32 left\nstring note\n",
            "warning[field-added]: robot_msgs/action/Walk_Feedback.note is new\n",
        ),
    ],
)
def test_services_and_actions(name: str, old: str, new: str, said: str, project: Path) -> None:
    kind = "action" if "action" in name else "service"
    roles = (f"{kind} server", f"{kind} client")
    text = explain(asdict(met(made(old, name), made(new, name), kind=kind, roles=roles, policy="refuse")))
    assert said in text
    assert "on_type_mismatch is refuse: no requests and responses pass between the two\n" in text
    assert f"\n      ifgen adapt {name} --from RIHS01_" in text


def test_a_part_of_a_service_is_found_in_the_file_of_the_whole(project: Path) -> None:
    name = "robot_msgs/srv/SetMode"
    file = project / "interfaces" / "robot_msgs" / "srv" / "SetMode.srv"
    file.parent.mkdir()
    file.write_text("uint16 mode\n---\nbool success\n")
    theirs, mine = (made(f"{kind} mode\n---\nbool success\n", name).Request for kind in ("uint8", "uint16"))
    mismatch = met(theirs, mine, kind="service", roles=("service server", "service client"))
    text = explain(asdict(mismatch))
    assert " --> interfaces/robot_msgs/srv/SetMode.srv:1:1\n" in text
    assert "\n      ifgen adapt robot_msgs/srv/SetMode --from RIHS01_a16c65e4c01407e2\n" in text


def test_a_part_that_ros_derives_is_nothing_to_adapt(project: Path) -> None:
    name = "robot_msgs/action/Walk"
    both = (f"int8 a\n---\nint8 b\n---\n{kind} c\n" for kind in ("int8", "int16"))
    theirs, mine = (made(text, name).Impl.FeedbackMessage for text in both)
    text = explain(asdict(met(theirs, mine, kind="action", roles=("action server", "action client"))))
    assert "robot_msgs/action/Walk_FeedbackMessage.feedback.c was" in text
    assert text.endswith("help: use the same definition in both nodes")


def test_where_an_adapter_converts_nothing_is_left_to_do(project: Path) -> None:
    text = explain(asdict(met(made(OLD), made(NEW), policy="adapt")))
    assert text.endswith(
        "\non_type_mismatch is adapt: an adapter converts messages between the two\n"
        "help: use the same definition in both nodes"
    )


@pytest.mark.parametrize("policy", ["warn", "refuse", "adapt"])
def test_on_a_topic_the_node_that_receives_decides_and_converts(policy: str, project: Path) -> None:
    mismatch = met(made(NEW), made(OLD), policy=policy, roles=("subscription", "publisher"))
    assert explain(asdict(mismatch)).endswith(
        "\nwhat becomes of the messages is for /driver to decide, by its on_type_mismatch\n"
        "help: use the same definition in both nodes. Until then, /driver can convert:\n"
        "      ifgen adapt robot_msgs/msg/BatteryState --from RIHS01_3c76ee04b5060378\n"
        "      and set its on_type_mismatch to adapt"
    )


def test_a_part_of_a_service_that_nobody_can_send_says_why(project: Path) -> None:
    name = "robot_msgs/srv/SetMode"
    theirs, mine = (made(f"{kind} mode\n---\nbool success\n", name).Request for kind in ("uint8", "uint16"))
    mismatch = met(theirs, mine, kind="service", roles=("service server", "service client"))
    said = "what differs is unknown: nodes cannot be asked for one part of a service, and\nnone"
    assert said in explain(without_definition(mismatch))


def test_bytes_that_mean_the_same_are_no_garbage(project: Path) -> None:
    text = explain(asdict(met(made("float32 volts\n"), made("float32 voltage\n"))))
    assert "messages still flow as far as ROS lets them, and their\nbytes mean the same\n" in text


def test_a_long_name_does_not_push_words_past_the_margin(project: Path) -> None:
    theirs, mine = (made(f"{kind} {'x' * 70}\n") for kind in ("int8", "int16"))
    (line, after) = explain(asdict(met(theirs, mine))).partition("warning")[2].splitlines()[:2]
    assert line.endswith("x")
    assert after == "  was `int8`, and is `int16`"


def test_many_changes_are_counted(project: Path) -> None:
    theirs = made("".join(f"int8 a{number}\n" for number in range(9)))
    mine = made("".join(f"int16 a{number}\n" for number in range(9)))
    text = explain(asdict(met(theirs, mine)))
    assert text.count("warning[field-type]") == 5
    assert "\n... and 4 more\n" in text


def test_definitions_that_differ_in_nothing_that_changes_a_hash_say_so() -> None:
    def known(text: str) -> Any:
        side = met(made(text), made(text)).mine
        return of_sources(asdict(side), BATTERY, None)

    found = differences(known("float32 x 0.1\n"), known("float32 x 0.2\n"), Installed(0.0))
    assert (found.changes, found.remark) == (
        (),
        "the two definitions differ only in defaults, which change no hash",
    )


def test_a_definition_that_is_too_large_is_not_compared(project: Path) -> None:
    levels = {f"robot_msgs/msg/L{n}": f"L{n + 1} a\nint8 x\nL{n + 1} b\n" for n in range(24)}

    def bomb(field: str) -> Any:
        return made("L0 a\n" + field, others=levels | {"robot_msgs/msg/L24": "int8 x\n"})

    text = explain(asdict(met(bomb("int8 x\n"), bomb("int16 x\n"))))
    assert "the definitions are too large to compare while programs run\n" in text


def test_without_time_the_project_alone_is_searched(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ifgen.evolution.explaining.explanation._PATIENCE", 0.0)
    mismatch = met(made(OLD), made(NEW))
    assert f" --> {PLACE}:9:7\n" in explain(asdict(mismatch))
    assert UNKNOWN in explain(without_definition(mismatch))


def test_whatever_goes_wrong_the_first_lines_are_there(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("a defect")

    monkeypatch.setattr("ifgen.evolution.explaining.explanation.differences", fail)
    text = explain(asdict(met(made(OLD), made(NEW))))
    assert text.startswith("topic '/battery': /driver (publisher) has another definition of\n")
    assert "defect" not in text


def test_a_project_that_cannot_be_read_is_none(project: Path) -> None:
    (project / "pyproject.toml").write_text("[tool.ifgen]\npaths = 3\n")
    assert " --> robot_msgs/msg/BatteryState.msg:7:9\n" in explain(asdict(met(made(OLD), made(NEW))))
