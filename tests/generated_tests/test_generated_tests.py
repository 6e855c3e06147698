"""Generated tests pass on generated code, on every rclpy, and fail on code that differs from the description."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from shutil import copyfile

import ifgen
import pytest

from .mutations import MUTATIONS
from .running import needs_rclpy, on_both, on_real_rclpy_slowly, run

HERE = Path(__file__).parent
NODES = sorted(path.name.removesuffix(".nodl.yaml") for path in (HERE / "nodes").iterdir())


def describe(folder: Path, package: str, node: str) -> None:
    """Write a package with the description of one of the nodes."""
    (folder / package / "nodl").mkdir(parents=True)
    copyfile(HERE / f"nodes/{node}.nodl.yaml", folder / package / f"nodl/{node}.nodl.yaml")


def replaced(text: str, old: str, new: str) -> str:
    assert old in text, f"there is no {old!r} to change in:\n{text}"
    return text.replace(old, new)


def edit(path: Path, changes: Mapping[str, str]) -> None:
    text = path.read_text()
    for old, new in changes.items():
        text = replaced(text, old, new)
    path.write_text(text)


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One package for each node, and one of messages."""
    folder = tmp_path_factory.mktemp("generated_tests")
    for node in NODES:
        describe(folder / "interfaces", f"of_{node}", node)
    (folder / "interfaces/thing_msgs/msg").mkdir(parents=True)
    (folder / "interfaces/thing_msgs/msg/Thing.msg").write_text((HERE / "msg/Thing.msg").read_text())
    ifgen.generate(folder / "interfaces", output=folder / "generated")
    return folder


@pytest.mark.timeout(300)
@on_real_rclpy_slowly
def test_they_pass(generated: Path, transport: str) -> None:
    failed, output = run(generated, f"--transport={transport}", path=[generated / "generated"])
    assert failed == {name: set() for name in [*(f"of_{node}" for node in NODES), "thing_msgs"]}, output
    assert "skipped" not in output
    assert "warning" not in output
    assert not list(generated.rglob(".hypothesis"))


@pytest.mark.slow
@needs_rclpy
@pytest.mark.timeout(300)
def test_they_pass_without_the_plugin(generated: Path, tmp_path: Path) -> None:
    """As in a colcon workspace: pytest, hypothesis, a real rclpy, and nothing of ifgen except the packages."""
    beside = [ifgen.resources.bundled_generated() / "example_interfaces", generated / "generated/thing_msgs"]
    for package in beside:  # ROS's compiled packages must win over ours, so not all of ours go on the path
        (tmp_path / package.name).symlink_to(package)
    failed, output = run(generated, "-p", "no:ifgen", path=[tmp_path])
    assert not any(failed.values()), output


def test_they_know_nothing_of_ifgen(generated: Path) -> None:
    files = list(generated.glob("generated/*/test/*.py"))
    assert len(files) == 3 * len(NODES) + 1
    for path in files:
        modules = re.findall(r"^\s*(?:from|import) (\w+)", path.read_text(), re.MULTILINE)
        assert not {name for name in modules if name.startswith("ifgen")}, path


GROUPS = ("contract", "parameters", "topics", "services", "actions", "rates")


@pytest.mark.parametrize(
    "groups",
    [pytest.param(("topics",), id="one"), pytest.param(GROUPS, id="all", marks=pytest.mark.slow)],
)
def test_groups(tmp_path: Path, groups: tuple[str, ...]) -> None:
    """Each group of tests works alone; the requested tests are there, and there are no unused imports."""
    for group in groups:
        for node in NODES:
            describe(tmp_path / "interfaces", f"{group}_of_{node}", node)
            path = tmp_path / f"interfaces/{group}_of_{node}/nodl/{node}.nodl.yaml"
            _, _, rest = path.read_text().replace("codegen:\n  ifgen:\n", "").partition("\n")
            path.write_text(f"nodl_version: 2\ncodegen:\n  ifgen:\n    tests: [{group}]\n{rest}")
    ifgen.generate(tmp_path / "interfaces", output=tmp_path / "generated")
    failed, output = run(tmp_path, "--transport=local", path=[tmp_path / "generated"])
    assert not any(failed.values()), output
    asked = {
        "parameters": "tuned",
        "topics": "talker",
        "services": "server",
        "actions": "actor",
        "rates": "managed",
    }
    for group in asked.keys() & groups:
        test = f"generated/{group}_of_{asked[group]}/test/test_{asked[group]}_contract.py"
        assert "def test_" in (tmp_path / test).read_text()
    assert len(failed) == len(groups) * len(NODES)
    ruff = [
        sys.executable,
        "-m",
        "ruff",
        "check",
        "--no-cache",
        "--select=F,I,E4,E7,E9",
        tmp_path / "generated",
    ]
    done = subprocess.run(ruff, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stdout


CALL = "self.switch_client.srv_type.Request()"
RATE = "rate = self.create_rate(100.0)\n        rate.sleep()\n        "
# Changes of the user's module of a node, and the tests that fail because they are about them.
USERS = {
    "quiet_talker": ({"self.publish_state(String())": "pass"}, {"test_publish_state"}),
    "failing_talker": (
        {"self.publish_state(String())": "raise ValueError", "self.get_logger()": "raise KeyError  #"},
        {"test_publish_state", "test_timer_does_no_harm[on_beat_timer]", "test_subscription[/command]"},
    ),
    "ending_talker": (
        {
            "ExternalShutdownException\n": "ExternalShutdownException, MultiThreadedExecutor\n",
            'self.get_logger().debug("message': "import time\n\n        rclpy.try_shutdown()\n        "
            'time.sleep(0.2)\n        self.get_logger().debug("message',
        },
        set(),
    ),
    "wrong_server": ({"return response": "response.sum = -1\n        return response"}, {"test_handle_add"}),
    "failing_server": ({"return response": "raise ValueError"}, {"test_handle_add", "test_service[~/add]"}),
    "asking_server": (
        {
            "(**options)": f"(**options)\n        self.call_switch({CALL})",
            "return response": f"self.call_switch({CALL})\n        return response",
        },
        set(),
    ),
    "asking_loop": (
        {
            "return response": "sent = self.send_count(self.count_action_client._action_type.Goal())\n"
            "        sent.add_done_callback(lambda done: done.result().get_result_async())\n"
            "        self.send_other(self.other_action_client._action_type.Goal())\n"
            "        return response"
        },
        set(),
    ),
    "rejecting_actor": (
        {
            "GoalResponse.ACCEPT": "GoalResponse.REJECT",
            "goal_handle.succeed()": "goal_handle.abort()",
        },
        {"test_execute_count"},
    ),
    "sleeping_actor": (
        {"goal_handle.publish": f"{RATE}goal_handle.publish", "return GoalR": f"{RATE}return GoalR"},
        set(),
    ),
    "waiting_thinker": ({"self.get_logger().debug(": "await self.sleep(0.01)\n        print("}, set()),
    "asking_thinker": (
        {
            'self.get_logger().debug("timer': f'await self.call_switch({CALL}, timeout_sec=5.0)\n        print("'
        },
        set(),
    ),
}


@pytest.mark.slow
@pytest.mark.timeout(300)
@on_both
def test_what_you_do_in_callbacks_is_yours(tmp_path: Path, transport: str) -> None:
    """The contract also holds for nodes that do more than new ones; that is for the user's own first test."""
    for package in USERS:
        describe(tmp_path / "interfaces", package, package.partition("_")[2])
    ifgen.generate(tmp_path / "interfaces", output=tmp_path / "generated")
    for package, (changes, _) in USERS.items():
        edit(tmp_path / f"generated/{package}/{package}/{package.partition('_')[2]}.py", changes)
    failed, output = run(tmp_path, f"--transport={transport}", path=[tmp_path / "generated"])
    assert failed == {package: fails for package, (_, fails) in USERS.items()}, output


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_whatever_changes_in_a_node_is_noticed(tmp_path: Path) -> None:
    """Change generated code in many ways, each in a package of its own, and run the tests of all of them."""
    packages = {f"m{number}_{mutation.node}": mutation for number, mutation in enumerate(MUTATIONS)}
    for package, mutation in packages.items():
        describe(tmp_path / "interfaces", package, mutation.node)
    ifgen.generate(tmp_path / "interfaces", output=tmp_path / "generated")
    for package, mutation in packages.items():
        path = mutation.path.format(package=package, node=mutation.node)
        edit(tmp_path / "generated" / package / path, {mutation.old: mutation.new})
    failed, output = run(tmp_path, "--transport=local", path=[tmp_path / "generated"])
    missed = {
        str(mutation): failed[package]
        for package, mutation in packages.items()
        if not any(name.startswith(mutation.noticed_by) for name in failed[package])
    }
    assert not missed, output[-5000:]


CHANGES = {
    "default": ("float32 size 1.5", "float32 size 2.5", "test_definition[Thing]"),
    "constant": ("STATE_BUSY=7", "STATE_BUSY=8", "test_definition[Thing]"),
    "name": ("byte flag", "byte sign", "test_definition[Thing]"),
    "type": ("float64[3] pose", "float32[3] pose", "test_definition[Thing]"),
    "array": ("float64[3] pose", "float64[4] pose", "test_refused[Thing]"),
    "string_bound": ("string<=5", "string<=6", "test_refused[Thing]"),
    "sequence_bound": ("int16[<=3]", "int16[<=4]", "test_refused[Thing]"),
    "range": ("uint8 state", "int8 state", "test_refused[Thing]"),
}


@pytest.mark.slow
def test_whatever_changes_in_a_message_is_noticed(tmp_path: Path) -> None:
    """As if a workspace had compiled other definitions than those that the tests were generated from."""
    text = (HERE / "msg/Thing.msg").read_text()
    folders = {f"{name}_msgs": change for name, change in CHANGES.items()}
    for which in ("before", "after"):
        for package, (old, new, _) in folders.items():
            (tmp_path / which / package / "msg").mkdir(parents=True)
            changed = replaced(text, old, new) if which == "after" else text
            (tmp_path / which / package / "msg/Thing.msg").write_text(changed)
    ifgen.generate(tmp_path / "before", output=tmp_path / "old")
    ifgen.generate(tmp_path / "after", output=tmp_path / "generated")
    for package in folders:
        test = f"{package}/test/test_{package}_interfaces.py"
        (tmp_path / "generated" / test).write_text((tmp_path / "old" / test).read_text())
    failed, output = run(tmp_path, "--transport=local", path=[tmp_path / "generated"])
    missed = [package for package, (_, _, noticed_by) in folders.items() if noticed_by not in failed[package]]
    assert not missed, output


def test_a_codec_that_loses_something_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IFGEN_CODEC", "python")  # the faults are in the functions of the module
    faults = {
        "bytes_msgs": ("_Thing_1[p & 3](m._flag,", "_Thing_1[p & 3](b'z',", "test_round_trip[Thing]"),
        "nan_msgs": ("m._state, x1, b3,", "m._state, x1 if x1 == x1 else 1.5, b3,", "test_nan[Thing]"),
    }
    for package in faults:
        (tmp_path / "interfaces" / package / "msg").mkdir(parents=True)
        (tmp_path / "interfaces" / package / "msg/Thing.msg").write_text((HERE / "msg/Thing.msg").read_text())
    ifgen.generate(tmp_path / "interfaces", output=tmp_path / "generated")
    for package, (old, new, _) in faults.items():
        edit(tmp_path / f"generated/{package}/msg/_thing.py", {old: new})
    failed, output = run(tmp_path, "--transport=local", path=[tmp_path / "generated"])
    assert failed == {package: {noticed_by} for package, (_, _, noticed_by) in faults.items()}, output
