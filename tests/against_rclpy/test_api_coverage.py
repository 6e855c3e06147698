"""Ours has every public name of the real rclpy, of the same kind, and accepts every call that the real one accepts.

`python test_api_coverage.py` prints the coverage module by module.
"""

from __future__ import annotations

import importlib.metadata
import importlib.util
import inspect
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
UNDERLAY = (ROOT / "codegen" / "underlay", ROOT / "generated", ROOT / "codegen")
SEAM = "seam"

POSITIONAL_ONLY, POSITIONAL, VAR_POSITIONAL, KEYWORD, VAR_KEYWORD = range(5)

# Names that ours deliberately leaves out, with the reason.
LEFT_OUT = {
    "rclpy.exceptions.InvalidParameterTypeException.Parameter": "an import inside a class body that leaks out of it",
}
_TYPING = "describes arguments of rclpy's own methods to type checkers; ours are typed in place"
LEFT_OUT_OF_KILTED = {
    **dict.fromkeys(
        ("rclpy.action.client.T", "rclpy.executors.T", "rclpy.task.T", "rclpy.waitable.T"), _TYPING
    ),
    "rclpy.action.client.SendGoalKWargs": _TYPING,
    "rclpy.callback_groups.TYPE_CHECKING": "an import that leaks",
    "rclpy.context.TYPE_CHECKING": "an import that leaks",
    "rclpy.destroyable.missing": "Jazzy has this module",
    **{
        f"rclpy.impl.rcutils_logger.{name}": _TYPING
        for name in (
            "LoggingArgs",
            "LoggingFilterArgs",
            "LoggingFilterParams",
            "OnceContext",
            "RcutilsLoggerContext",
            "SkipFirstContext",
            "ThrottleContext",
        )
    },
    "rclpy.InitContextManager": "only `init` makes one",
    "rclpy.lifecycle.node.CreateLifecyclePublisherArgs": _TYPING,
    "rclpy.lifecycle.node.LifecycleNodeArgs": _TYPING,
    "rclpy.lifecycle.node.LifecycleNode.ParameterInput": _TYPING,
    "rclpy.node.AllowableParameterValueT": _TYPING,
    "rclpy.node.Node.ParameterInput": _TYPING,
    "rclpy.parameter.AllowableParameterValueT": _TYPING,
    "rclpy.qos.InvalidQoSProfileException": "takes the same argument without its name",
    "rclpy.topic_endpoint_info.TypeHashDictionary": _TYPING,
    "rclpy.type_hash.TypeHashDictionary": _TYPING,
    **{
        f"rclpy.type_support.{name}.{method}": "a method of `type`"
        for name in ("CommonMsgSrvMetaClass", "MsgMetaClass")
        for method in ("mro", "register")
    },
}
# Names that only ours has, with the reason.
ADDED = {
    "Executor.create_future": "the releases of Jazzy after the one on the package index have it",
    "rclpy.InitContextManager": "the result of `init`, which is None in Jazzy",
    **{
        f"Node.get_action_{which}_names_and_types_by_node": "the rest of `action_graph` of rclpy.impl.distro"
        for which in ("client", "server")
    },
    "ParameterEventHandler.parameter_callbacks": "the real one has it; only a longer annotation hides it",
}
# Parameters that only ours has, with the reason.
ADDED_PARAMETERS = {
    "Node.create_subscription: has no parameter views": "asked for; docs/numpy.md says what runs on both",
}


def _release() -> str:
    """The version of the real rclpy, empty without one: 7 is Jazzy's, 9 is Kilted's."""
    try:
        return importlib.metadata.version("ros-rclpy")
    except importlib.metadata.PackageNotFoundError:
        return ""


REFERENCE = "kilted" if _release().startswith("9.") else "jazzy"


def newer_words() -> set[str]:
    """The words of the tables in `rclpy.impl.distro`, which list what is newer than the wheels of Jazzy."""
    program = "from rclpy.impl.distro import API; print(*(api.subject for api in API.values()))"
    path = os.pathsep.join(map(str, UNDERLAY))
    ended = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    return set(re.findall(r"\w+", ended.stdout))


def concerns(fault: str) -> str:
    """The class, method or parameter that a fault is about."""
    subject, _, problem = fault.partition(": ")
    return subject.rpartition(".")[2].split()[0] if not problem or "*" in problem else problem.split()[-1]


Description = dict[str, Any]


@dataclass
class Coverage:
    """The comparison of one module, and what is wrong."""

    names: int = 0
    signatures: int = 0
    faults: list[str] = field(default_factory=list)


def describe(*, ours: bool, names: dict[str, list[str]] | None = None) -> dict[str, dict[str, Description]]:
    """Describe ours or the real one, each in a process of its own; `names` (None: all public ones) by module."""
    asked_for = "" if names is None else json.dumps(names)
    api: dict[str, dict[str, Description]] = ask("describe_api.py", ours=ours, text=asked_for)
    return api


def ask(program: str, *, ours: bool, text: str = "") -> Any:
    """Run a program of this folder on ours or on the real one; return the JSON that it prints."""
    path = os.pathsep.join(map(str, UNDERLAY)) if ours else ""
    ended = subprocess.run(
        [sys.executable, str(HERE / program)],
        env={**os.environ, "PYTHONPATH": path, "IFGEN_ROS_DISTRO": REFERENCE},
        input=text,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    return json.loads(ended.stdout)


def coverage_of_ours() -> dict[str, Coverage]:
    """Compare ours with the real one, module by module."""
    real = describe(ours=False)
    return compare(real, describe(ours=True, names={module: list(names) for module, names in real.items()}))


def compare(
    real: dict[str, dict[str, Description]], ours: dict[str, dict[str, Description]]
) -> dict[str, Coverage]:
    """Compare module by module."""
    result = {}
    for module, names in real.items():
        coverage = result[module] = Coverage()
        there = ours.get(module, {})
        if "missing" in there:
            coverage.names = len(names)
            coverage.faults.append(f"module {module} cannot be imported: {there['missing']}")
            continue
        for name, description in names.items():
            _compare_one(f"{module}.{name}", description, there.get(name), coverage)
    return result


def _compare_one(name: str, real: Description, ours: Description | None, coverage: Coverage) -> None:
    coverage.names += 1
    if name in LEFT_OUT or (REFERENCE == "kilted" and name in LEFT_OUT_OF_KILTED):
        return
    if ours is None:
        coverage.faults.append(f"{name} is missing")
        return
    if real["kind"] != ours["kind"]:
        coverage.faults.append(f"{name} is a {ours['kind']}, not a {real['kind']}")
        return
    for member, description in real.get("members", {}).items():
        _compare_one(f"{name}.{member}", description, ours["members"].get(member), coverage)
    if real.get("signature") is not None and ours.get("signature") is not None:
        coverage.signatures += 1
        coverage.faults += [f"{name}: {fault}" for fault in refused(real["signature"], ours["signature"])]


def refused(real: list[list[Any]], ours: list[list[Any]]) -> Iterator[str]:
    """Return the calls that fit the real signature but not ours."""
    by_name = {name: (kind, has_default) for name, kind, has_default in ours}
    kinds = {kind for _, kind, _ in ours}
    positions = [name for name, kind, _ in ours if kind in (POSITIONAL_ONLY, POSITIONAL)]
    for index, (name, kind, has_default) in enumerate(real):
        if kind in (VAR_POSITIONAL, VAR_KEYWORD):
            if kind not in kinds:
                yield f"takes no {'*' if kind == VAR_POSITIONAL else '**'}{name}"
            continue
        our_kind, our_default = by_name.get(name, (None, True))
        if our_kind is None:
            if kind != POSITIONAL_ONLY and VAR_KEYWORD not in kinds:
                yield f"has no parameter {name}"
            continue
        in_place = our_kind == POSITIONAL and positions[index : index + 1] == [name]
        if kind == POSITIONAL and not in_place and VAR_POSITIONAL not in kinds:
            yield f"takes {name} at another position"
        if has_default and not our_default:
            yield f"requires {name}"
    known = {name for name, _, _ in real}
    for name, kind, has_default in ours:
        if name not in known and not has_default and kind not in (VAR_POSITIONAL, VAR_KEYWORD):
            yield f"requires {name}, which the real one does not have"


def summary(result: dict[str, Coverage]) -> str:
    """Return the coverage as lines of text."""
    lines = [
        f"{module:45} {each.names:4} names {each.signatures:4} signatures {len(each.faults):3} faults"
        for module, each in result.items()
    ]
    names = sum(each.names for each in result.values())
    faults = [fault for each in result.values() for fault in each.faults]
    lines.append(f"{names} names compared, {100 * (1 - len(faults) / names):.1f} % without a fault")
    return "\n".join([*lines, *faults])


needs_the_real_one = pytest.mark.skipif(
    importlib.util.find_spec("rclpy") is None, reason="the real rclpy is not installed (Linux x86_64 only)"
)


@needs_the_real_one
def test_every_public_name_and_signature_is_there() -> None:
    """No name is missing or of another kind, and none refuses a call."""
    result = coverage_of_ours()
    print(summary(result))
    assert sum(each.names for each in result.values()) > 1000
    assert not [fault for each in result.values() for fault in each.faults]


needs_jazzy = pytest.mark.skipif(REFERENCE != "jazzy", reason="the profile is that of Jazzy's wheels")


@pytest.mark.slow
@needs_the_real_one
@needs_jazzy
def test_there_is_no_public_name_that_upstream_lacks() -> None:
    """Code for ours works on the real one: rclpy has no names that upstream lacks, and accepts no more calls."""
    ours = describe(ours=True)

    def is_public(home: str) -> bool:  # the rest are our internals
        return home in ours or home.partition(".")[0].endswith(("_msgs", "_interfaces"))

    names = {
        module: [name for name, description in there.items() if is_public(description["home"])]
        for module, there in ours.items()
        if module != SEAM
    }
    real = describe(ours=False, names=names)
    wanted = {module: {name: ours[module][name] for name in names[module]} for module in names}
    faults = [fault for each in compare(wanted, real).values() for fault in each.faults]
    assert sum(map(len, names.values())) > 300
    known, newer = (*(f"{name} is missing" for name in ADDED), *ADDED_PARAMETERS), newer_words()
    unknown = [fault for fault in faults if not any(each in fault for each in known)]
    assert not [fault for fault in unknown if concerns(fault) not in newer]


@pytest.mark.slow
@needs_the_real_one
@needs_jazzy
def test_the_same_modules_can_be_reached_after_each_import() -> None:
    """`import rclpy; rclpy.qos` fails or works on both, and the same holds after any other import line."""
    real, ours = (ask("reachable_modules.py", ours=each) for each in (False, True))
    assert real["import rclpy"] != real["import rclpy.node"]
    assert ours == real


@pytest.mark.slow
@needs_the_real_one
def test_no_newer_wheels_have_come() -> None:
    """The yardstick is the newest there is. If this fails: `make clean`, and see what the new wheels change."""
    name = f"ros-{REFERENCE}-rclpy"
    command = [sys.executable, "-m", "pip", "index", "versions", name]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    newest = re.search(r"LATEST: +(\S+)", ended.stdout)
    if newest is None:
        pytest.skip("the package index does not answer")
    assert newest[1] == importlib.metadata.version(name)


def _signature_of(function: Any) -> list[list[Any]]:
    return [
        [each.name, int(each.kind), each.default is not each.empty]
        for each in inspect.signature(function).parameters.values()
    ]


def _real_example(a, b=1, *, c=None):  # type: ignore[no-untyped-def]  # only its signature matters
    pass


@pytest.mark.parametrize(
    ("ours", "faults"),
    [
        (lambda a, b=2, *, c=0, d=5: 0, []),
        (lambda a, *rest, b=2, c=0: 0, []),
        (lambda a, b, *, c=0: 0, ["requires b"]),
        (lambda b=1, a=0, *, c=0: 0, ["takes a at another position", "takes b at another position"]),
        (lambda a, b=1: 0, ["has no parameter c"]),
        (lambda a, b=1, *, c=0, d: 0, ["requires d, which the real one does not have"]),
    ],
)
def test_the_comparison_sees_what_it_should(ours: Any, faults: list[str]) -> None:
    """The comparison finds calls that a signature would refuse, and no others."""
    assert list(refused(_signature_of(_real_example), _signature_of(ours))) == faults


if __name__ == "__main__":
    print(summary(coverage_of_ours()))
