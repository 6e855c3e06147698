"""Launch tests as users write them, run by pytest and by `launch_test`, on each transport."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from .test_programs import needs_rclpy

TALKER = """
import sys
import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("talker")
publisher = node.create_publisher(String, "chat", 10)
print("says", sys.argv[1], flush=True)
node.get_logger().info("began")
node.create_timer(0.05, lambda: publisher.publish(String(data=sys.argv[1])))
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
"""
TESTS = """
import unittest
import launch
import launch.actions
import launch_ros.actions
import launch_testing.actions
import launch_testing.asserts
import launch_testing.markers
import pytest
import rclpy
from std_msgs.msg import String


@pytest.mark.launch_test
@launch_testing.markers.keep_alive
@launch_testing.parametrize("word", ["a", "b"])
def generate_test_description(word):
    talker = launch_ros.actions.Node(executable="talker.py", arguments=[word])
    ready = launch.actions.TimerAction(period=0.1, actions=[launch_testing.actions.ReadyToTest()])
    return launch.LaunchDescription([talker, ready]), {"talker": talker}


class TestTalker(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rclpy.init()

    @classmethod
    def tearDownClass(cls):
        rclpy.shutdown()

    def setUp(self):
        self.node = rclpy.create_node("test_talker")

    def tearDown(self):
        self.node.destroy_node()

    def test_it_says_a_word(self, proc_output, proc_info, launch_service, talker, word):
        proc_info.assertWaitForStartup(process="talker", timeout=30)
        proc_output.assertWaitFor(f"says {word}", process=talker, timeout=30)
        proc_output.assertWaitFor("began", process=talker, timeout=30, stream="stderr")
        heard = []
        self.node.create_subscription(String, "chat", lambda message: heard.append(message.data), 10)
        end = self.node.get_clock().now() + rclpy.duration.Duration(seconds=30)
        while not heard and self.node.get_clock().now() < end:
            rclpy.spin_once(self.node, timeout_sec=0.1)
        self.assertEqual(heard[0], EXPECTED)

    def test_a_process_of_its_own(self, launch_service, proc_info, proc_output):
        echo = launch.actions.ExecuteProcess(cmd=["sh", "-c", "echo one; echo two >&2; exit 3"])
        with launch_testing.tools.launch_process(launch_service, echo, proc_info, proc_output) as process:
            self.assertTrue(process.wait_for_shutdown(20))
        self.assertEqual((process.exit_code, process.stdout, process.stderr), (3, "one\\n", "two\\n"))
        self.assertTrue(launch_testing.tools.expect_output(expected_lines=["one"], text=process.stdout, strict=True))


@launch_testing.post_shutdown_test()
class TestAfterwards(unittest.TestCase):
    def test_exit_codes(self, proc_info, talker):
        launch_testing.asserts.assertExitCodes(proc_info, process=talker)

    def test_output(self, proc_output, talker, word):
        with launch_testing.asserts.assertSequentialStdout(proc_output, talker) as checker:
            checker.assertInStdout(f"says {word}")
"""


def run(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    (folder / "talker.py").write_text(TALKER)
    environment = {**os.environ, "ROS_LOG_DIR": str(folder / "log")}
    for name in [name for name in environment if name.startswith("PYTEST_") or name == "PYTHONPATH"]:
        del environment[name]
    return subprocess.run(
        [sys.executable, "-m", *words],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=150,
        check=False,
    )


def by_pytest(folder: Path, transport: str = "local") -> subprocess.CompletedProcess[str]:
    return run(folder, "pytest", "-q", "--strict-markers", "--transport", transport, "test_it.py")


@pytest.mark.slow
@pytest.mark.parametrize("transport", ["local", pytest.param("rclpy", marks=needs_rclpy)])
def test_a_launch_test_passes(transport: str, tmp_path: Path) -> None:
    (tmp_path / "test_it.py").write_text(TESTS.replace("EXPECTED", "word"))
    done = by_pytest(tmp_path, transport)
    assert done.returncode == 0, done.stdout
    assert "1 passed" in done.stdout


@pytest.mark.slow
def test_a_failure_shows_the_assertion(tmp_path: Path) -> None:
    (tmp_path / "test_it.py").write_text(TESTS.replace("EXPECTED", "'c'"))
    done = by_pytest(tmp_path)
    assert done.returncode == 1
    assert "AssertionError: 'a' != 'c'" in done.stdout
    assert "FAIL: test_it_says_a_word" in done.stdout
    done = run(
        tmp_path, "ifgen", "run", "--transport", "local", "-m", "launch_testing.launch_test", "test_it.py"
    )
    assert done.returncode == 1
    assert done.stderr.count("FAIL: test_it_says_a_word") == 2


SHORT = """
import unittest
import launch
import launch_testing
import launch_testing.actions
import pytest

@pytest.mark.launch_test
@launch_testing.ready_to_test_action_timeout(0.5)
def generate_test_description():
    return launch.LaunchDescription([ENTITIES])

class Test(unittest.TestCase):
    def test_it(self):
        pass
"""
DIES = "launch.actions.ExecuteProcess(cmd=['sh', '-c', 'echo last words; exit 3'])"
LATE = "launch.actions.TimerAction(period=READY, actions=[launch_testing.actions.ReadyToTest()])"


@pytest.mark.parametrize(
    ("entities", "message"),
    [
        ("", "must return a LaunchDescription containing a ReadyToTest action"),
        (LATE.replace("READY", "50.0"), "Timed out waiting for processes to start up (0.5 s)"),
        (
            f"{DIES}, launch.actions.RegisterEventHandler(launch.event_handlers.OnProcessExit("
            f"on_exit=launch.actions.Shutdown())), {LATE.replace('READY', '50.0')}",
            "Processes under test stopped before tests completed\nProcess 'sh-1' exited with 3; its output:\nlast words",
        ),
    ],
    ids=["no action", "late", "died"],
)
@pytest.mark.slow
def test_launches_that_do_not_begin(entities: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "test_it.py").write_text(SHORT.replace("ENTITIES", entities))
    done = by_pytest(tmp_path)
    assert done.returncode == 1
    assert message in done.stdout, done.stdout
