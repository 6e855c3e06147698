"""Never-compiled classes on real rclpy: what works, and each hazard in its own process with a time limit."""

import json
import os
import re
from pathlib import Path

import ifgen
import pytest

from .support import (
    GENERATED,
    PROGRAMS,
    ROOT,
    needs_rclpy,
    never_compiled,
    run_python,
)

INTERFACES = ROOT / "interfaces"

pytestmark = needs_rclpy


# rclpy itself sometimes ends like this while a daemon thread spins, just as often with compiled classes alone.
RCLPY_ABORT = (-6, "terminate called without an active exception\n")


DROPPED = re.compile(
    r"\[WARN\] \[[\d.]+\] \[malformed\]: topic '/(joints|texts)': "
    r"((?:a message|\d+ messages) of a publisher did not fit|8 bytes of a message of a publisher were left over after)"
    r" (?:sensor_msgs/msg/JointState|std_msgs/msg/String)(?:, and were dropped|\. The message was delivered)\."
    r" Probably they were made with another definition of the type\. This is said once\."
)


def run(program: str, *, limit: float = 60.0, may_abort: bool = False) -> str:
    """The output of a program, which must end on its own, with success."""
    program_path = str(PROGRAMS / f"{program}.py")
    ran = run_python(program_path, limit=limit)
    code, words = RCLPY_ABORT
    # CPython 3.12 and newer warn about forks before.
    if not (may_abort and ran.returncode == code and ran.stderr.endswith(words)):
        assert ran.returncode == 0, ran.stdout + ran.stderr
    # rcutils prints this when an error text remains that nobody reads.
    assert "error state is being overwritten" not in ran.stderr, ran.stderr
    return ran.stdout


def test_topics_services_actions_and_descriptions_work() -> None:
    request = "humanoid_interfaces.srv.AddTwoInts_Request(a=2, b=40)"
    response = "humanoid_interfaces.srv.AddTwoInts_Response(sum=42)"
    assert run("interfaces").splitlines() == [
        "topic True",
        "hash True",
        "service 42",
        f" event 0 [{request}] []",
        f" event 1 [{request}] []",
        f" event 2 [] [{response}]",
        f" event 3 [] [{response}]",
        "service 42",
        *(f" event {number} [] []" for number in range(4)),
        "action 4 1 [1.0]",
        "rejected True",
        "canceling 1",
        "described True humanoid_interfaces/msg/FootstepPlan",
        " source humanoid_interfaces/msg/FootstepPlan msg True",
        " source humanoid_interfaces/msg/Footstep msg True",
    ]


def test_compiled_and_never_compiled_classes_of_one_type_understand_each_other() -> None:
    lines = run("interop").splitlines()
    assert len(lines) == 12
    assert all(line.endswith("[True, True]") for line in lines), lines


def test_arrays_reach_compiled_classes() -> None:
    frame = [*range(24)]
    mirrored = [
        frame[row + column + channel] for row in (0, 12) for column in (8, 4, 0) for channel in range(4)
    ]
    assert run("arrays").splitlines() == [
        f"Image data {frame}",
        f"Image data {mirrored}",
        "JointState position [0.1, 0.2]",
        "JointState name ['a', 'b']",
        "Imu orientation_covariance [0.1, 0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.3]",
        "UnboundedSequences bool_values [True, False]",
        "UnboundedSequences byte_values [b'a', b'b']",
    ]


def test_every_type_of_the_bundled_packages_works(tmp_path: Path) -> None:
    """Types of packages that rclpy itself needs are compiled, and stay so."""
    rclpys = {"builtin_interfaces", "unique_identifier_msgs", "type_description_interfaces"}
    rclpys |= {f"{name}_msgs" for name in ("action", "lifecycle", "rosgraph", "service")} | {"rcl_interfaces"}
    names = [path.name for path in sorted(INTERFACES.iterdir()) if path.name not in rclpys]
    names = [name for name in names if any((GENERATED / name).glob("[msa]*/_*.py"))]
    folder = never_compiled(tmp_path / "generated", names)
    environment = {"PYTHONPATH": os.pathsep.join((str(folder), str(ROOT / "codegen")))}
    ran = run_python(str(PROGRAMS / "every_type.py"), *names, environment=environment, limit=100)
    assert ran.returncode == 0, ran.stderr
    counts = json.loads(ran.stdout.replace("'", '"'))
    assert counts["msg"] > 150 and counts["srv"] > 20 and counts["action"] > 4, counts


def test_every_type_of_an_own_package_works(tmp_path: Path) -> None:
    """The types of codec_msgs, which has forms that the bundled ones lack, such as messages in .idl files."""
    ifgen.generate(ROOT / "tests" / "codec" / "codec_msgs", output=tmp_path)
    environment = {"PYTHONPATH": os.pathsep.join((str(tmp_path), str(ROOT / "codegen")))}
    ran = run_python(str(PROGRAMS / "every_type.py"), "codec_msgs", environment=environment, limit=100)
    assert ran.returncode == 0, ran.stderr
    ran = run_python(str(PROGRAMS / "characters.py"), environment=environment)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.splitlines() == ["'\\xff' abc k m", "13 61 ['idl', 'idl']"]


def test_malformed_payloads_are_dropped_and_the_node_goes_on() -> None:
    ran = run_python(str(PROGRAMS / "malformed.py"))
    assert (ran.returncode, ran.stdout) == (0, "[[], ['a']]\n"), ran.stderr
    # One line per topic and trouble, however much a peer sends.
    lines = ran.stderr.splitlines()
    told = [found.group(1, 2) for found in map(DROPPED.fullmatch, lines) if found]
    assert (sorted(topic for topic, _ in told), len(lines)) == (["joints", "joints", "texts"], 3), lines
    assert sum("left over" in trouble for _, trouble in told) == 1, lines


def test_a_wrong_value_raises_the_original_error_at_the_caller() -> None:
    first, second, third, fourth, last = run("wrong_value").splitlines()
    assert first == (
        "SerializationError FootstepPlan.steps[0].index: expected an integer in [0, 4294967295], got -1"
    )
    assert second.startswith(
        "TypeError Expected <class 'humanoid_interfaces.msg._footstep_plan.FootstepPlan'>"
    )
    assert third == "SerializationError AddTwoInts_Request.a: expected int, got str"
    assert fourth == (  # a UnicodeEncodeError, as of compiled classes
        "TextEncodingError EmergencyStop.source: half of a surrogate pair at character 4 cannot be sent"
    )
    assert last == "goes on"


def test_threads_that_publish_and_take_on_one_topic_do_not_deadlock() -> None:
    assert run("threads") == "stuck 0\npublished True taken True errors []\n"


@pytest.mark.slow
def test_memory_is_flat() -> None:
    assert run("memory", limit=110).splitlines() == [
        "messages True grown by less than 1 MiB True",
        "entities grown by less than 4 MiB True",
    ]


def test_concurrent_goals_finish() -> None:
    assert run("goals") == f"finished {[4] * 8} feedback True\n"


def test_forking_and_leaving_while_spinning_is_safe() -> None:
    assert run("leaving", may_abort=True) == "child 7\nleaving\n"
