"""The log file of a process: its place, when it begins and ends, and its contents."""

import os
import re
import tempfile
from pathlib import Path

import rclpy
from rclpy.logging import get_logger

FOLDER = Path(tempfile.mkdtemp())
LOG = get_logger("logger")


def show(label: str) -> None:
    """Print the files and their text, without parts that differ between runs, and remove them."""
    print(f"-- {label}")
    for path in sorted(FOLDER.rglob("*.log")):
        print(re.sub(r"\d{3,}", "N", str(path.relative_to(FOLDER))))
        print(re.sub(r"\d{10}\.\d{9}", "TIME", path.read_text()), end="")
        path.unlink()


def one_run(label: str, *arguments: str) -> None:
    """Log something between init and shutdown."""
    rclpy.init(args=["program", "--ros-args", *arguments] if arguments else None)
    LOG.debug("no")
    LOG.info("one")
    LOG.error("two\nlines \u00e9")
    rclpy.shutdown()
    show(label)


def main() -> None:
    os.environ["ROS_LOG_DIR"] = str(FOLDER / "deep" / "er")
    LOG.error("before init")
    one_run("plain")
    LOG.error("between")
    one_run("again")
    one_run("none", "--disable-external-lib-logs")
    one_run("no console", "--disable-stdout-logs")
    one_run("name", "--log-file-name", "my_robot")
    one_run("level", "--log-level", "logger:=error")
    del os.environ["ROS_LOG_DIR"]
    os.environ["ROS_HOME"] = str(FOLDER / "ros home")
    one_run("home")

    first, second = rclpy.Context(), rclpy.Context()
    first.init(["program", "--ros-args", "--log-file-name", "first"])
    second.init(["program", "--ros-args", "--log-file-name", "second"])
    LOG.error("both up")
    first.shutdown()
    LOG.error("one up")
    second.shutdown()
    LOG.error("none up")
    show("contexts share it")
