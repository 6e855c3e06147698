"""From saving an edited .msg to the first message of that type in a node on real rclpy: ifgen beside colcon.

    python benchmarks/edit_to_run.py [--colcon PREFIX]

A package of five interfaces; each round adds a field to one message, then runs the commands that its author
would type, in processes of their own, until the node has received a message with the new field. Seconds of
wall clock and of CPU; medians of several edits, half of them before colcon's and half after. colcon is
measured in the same run if PREFIX/bin has it together with ament_cmake and rosidl's generators (a sourced
ROS, or an environment of wheels); otherwise the table quotes an earlier measurement.
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

ROUNDS = 7
IFGEN = str(Path(sys.executable).with_name("ifgen"))
# From this script with --colcon on 2 idle cores; colcon and its dependencies were wheels of ROS 2 Jazzy.
# On busy cores both take longer: 62 s after an edit, and ifgen 1.2 s.
COLCON_ONCE = 20.7

PACKAGE = "edited_msgs"
INTERFACES = {
    "msg/Reading.msg": "std_msgs/Header header\nfloat64[] values\n",
    "msg/Limit.msg": "float64 lower\nfloat64 upper\n",
    "msg/Report.msg": "Reading[] readings\nLimit[] limits\nstring text\n",
    "srv/SetLimit.srv": "Limit limit\n---\nbool success\nstring message\n",
    "action/Calibrate.action": "float64 target\n---\nReading result\n---\nfloat32 progress\n",
}
NODE = f"""
import rclpy
from {PACKAGE}.msg import Reading
rclpy.init()
node = rclpy.create_node("edited")
received = []
node.create_subscription(Reading, "reading", received.append, 10)
publisher = node.create_publisher(Reading, "reading", 10)
reading = Reading(values=[1.0])
node.create_timer(0.001, lambda: publisher.publish(reading))
while not received:
    rclpy.spin_once(node)
print(sum(field.startswith("added_") for field in received[0].get_fields_and_field_types()), flush=True)
rclpy.shutdown()
"""
PACKAGE_XML = f"""<package format="3">
<name>{PACKAGE}</name><version>0.0.0</version><description>-</description>
<maintainer email="nobody@example.com">-</maintainer><license>-</license>
<buildtool_depend>ament_cmake</buildtool_depend>
<buildtool_depend>rosidl_default_generators</buildtool_depend>
<depend>std_msgs</depend><depend>action_msgs</depend>
<exec_depend>rosidl_default_runtime</exec_depend>
<member_of_group>rosidl_interface_packages</member_of_group>
<export><build_type>ament_cmake</build_type></export>
</package>
"""
CMAKE = f"""cmake_minimum_required(VERSION 3.8)
project({PACKAGE})
find_package(ament_cmake REQUIRED)
find_package(rosidl_default_generators REQUIRED)
find_package(std_msgs REQUIRED)
rosidl_generate_interfaces(${{PROJECT_NAME}} {" ".join(INTERFACES)} DEPENDENCIES std_msgs)
ament_package()
"""


class Cost(NamedTuple):
    """Seconds."""

    wall: float
    cpu: float


class Workspace:
    """A folder with the package and the node, and an environment to run commands in."""

    def __init__(self, folder: Path, **environment: str) -> None:
        self.folder = folder
        # Variables that a user's shell lacks: this interpreter's own, and the one that suppresses byte code.
        hidden = {
            "LD_LIBRARY_PATH",
            "_ROS_WHEELS_BOOTSTRAP_COMPLETE",
            "PYTHONPATH",
            "PYTHONDONTWRITEBYTECODE",
        }
        inherited = {key: value for key, value in os.environ.items() if key not in hidden}
        local = {"ROS_DOMAIN_ID": "98", "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
        self.environment = {**inherited, **local, **environment}
        source = folder / "src" / PACKAGE
        for name, text in {**INTERFACES, "package.xml": PACKAGE_XML, "CMakeLists.txt": CMAKE}.items():
            (source / name).parent.mkdir(parents=True, exist_ok=True)
            (source / name).write_text(text)
        (folder / "node.py").write_text(NODE)
        (folder / "pyproject.toml").write_text('[tool.ifgen]\npaths = ["src"]\n')
        self.message = source / "msg" / "Reading.msg"
        self.added = 0

    def edit(self) -> None:
        """Add a field to a message that the node uses."""
        self.added += 1
        with self.message.open("a") as file:
            file.write(f"float32 added_{self.added}\n")

    def run(self, *command: str) -> None:
        """Run a command that prepares the node."""
        subprocess.run(command, cwd=self.folder, env=self.environment, check=True, stdout=subprocess.DEVNULL)

    def until_received(self, *command: str) -> float:
        """Run the node; returns the time at which it reports a message with all fields."""
        with subprocess.Popen(
            command, cwd=self.folder, env=self.environment, stdout=subprocess.PIPE, text=True
        ) as node:
            assert node.stdout is not None
            line = node.stdout.readline()
            received = time.perf_counter()
        if line.strip() != str(self.added):
            sys.exit(f"the node saw {line.strip() or 'no message'}, expected {self.added} added fields")
        return received

    def cost(self, steps: Steps) -> Cost:
        """The cost from an edit until the node has received a message."""
        self.edit()
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        start = time.perf_counter()
        wall = steps(self) - start
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return Cost(wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


Steps = Callable[
    [Workspace], float
]  # runs what a user types; returns the time at which the node has received a message


def with_ifgen(workspace: Workspace) -> float:
    """Run what a user of ifgen types."""
    return workspace.until_received(IFGEN, "run", "--generate", "--transport", "rclpy", "node.py")


def with_two_commands(workspace: Workspace) -> float:
    """Run what a user types who wants to run the node with plain Python."""
    workspace.run(IFGEN, "generate")
    return workspace.until_received("sh", "-c", f"PYTHONPATH=generated exec {sys.executable} node.py")


def with_colcon(prefix: Path) -> Steps:
    """Run what a user of colcon types, with the tools of this prefix."""

    def steps(workspace: Workspace) -> float:
        workspace.run(str(prefix / "bin" / "colcon"), "build")
        run = f". install/setup.sh && exec {prefix / 'bin' / 'python'} node.py"
        return workspace.until_received("sh", "-c", run)

    return steps


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--colcon", type=Path, metavar="PREFIX", help="where bin/colcon is")
    prefix: Path | None = parser.parse_args().colcon
    with tempfile.TemporaryDirectory() as folder:
        ours = Workspace(Path(folder) / "ifgen")
        first = ours.cost(with_ifgen)
        costs = edits(ours), edits(ours, with_two_commands)
        theirs = [] if prefix is None else build_twice(Path(folder) / "colcon", prefix)
        one = median(costs[0] + edits(ours))
        two = median(costs[1] + edits(ours, with_two_commands))
    print("| | wall, s | CPU, s | wall, colcon / ifgen | CPU, colcon / ifgen |\n|---|---:|---:|---:|---:|")
    rows = (("first build", first), ("after an edit", one), ("after an edit, two commands", two))
    for name, cost in rows:
        print(f"| ifgen, {name} | {cost.wall:.2f} | {cost.cpu:.2f} | | |")
    for (name, mine), cost in zip(rows, theirs, strict=False):
        ratios = f"{cost.wall / mine.wall:.0f}x | {cost.cpu / mine.cpu:.0f}x"
        print(f"| colcon, {name} | {cost.wall:.2f} | {cost.cpu:.2f} | {ratios} |")
    if not theirs:
        ratio = COLCON_ONCE / one.wall
        print(f"| colcon, measured once, not in this run | {COLCON_ONCE} | | {ratio:.0f}x | |")


def edits(workspace: Workspace, steps: Steps = with_ifgen) -> list[Cost]:
    """The cost of each of several edits."""
    return [workspace.cost(steps) for _ in range(ROUNDS)]


def median(costs: list[Cost]) -> Cost:
    """Medians of wall clock and CPU."""
    return Cost(*(statistics.median(column) for column in zip(*costs, strict=True)))


def build_twice(folder: Path, prefix: Path) -> list[Cost]:
    """The cost of colcon for the whole package, and again after an edit."""
    environment = {
        "PATH": f"{prefix / 'bin'}:{os.environ['PATH']}",
        "CMAKE_PREFIX_PATH": str(prefix),
        "AMENT_PREFIX_PATH": str(prefix),
    }
    workspace = Workspace(folder, **environment)
    return [workspace.cost(with_colcon(prefix)) for _ in range(2)]


if __name__ == "__main__":
    main()
