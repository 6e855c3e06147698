"""Log files in cases without a counterpart in the real rclpy."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
import rclpy
from rclpy.logging import get_logger


@pytest.fixture
def context() -> Iterator[rclpy.Context]:
    context = rclpy.Context()
    yield context
    context.try_shutdown()


def test_a_program_that_logs_nothing_leaves_no_file(
    context: rclpy.Context, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "log"))
    rclpy.init(context=context)
    rclpy.create_node("silent", context=context).destroy_node()
    context.shutdown()
    assert not (tmp_path / "log").exists()


def test_where_no_file_can_be_made_logging_goes_on(
    context: rclpy.Context, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "file" / "log"))
    rclpy.init(context=context)
    assert get_logger("a").info("one")
    assert get_logger("a").info("two")
    errors = capfd.readouterr().err
    assert errors.count("the log goes to no file") == 1
    assert "[a]: one\n" in errors
    assert "[a]: two\n" in errors


def test_lines_of_several_threads_stay_whole(
    context: rclpy.Context, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path))
    rclpy.init(args=["--ros-args", "--disable-stdout-logs"], context=context)

    def log(name: str) -> None:
        for number in range(200):
            get_logger(name).warning(f"{name}{number}" * 20)

    threads = [threading.Thread(target=log, args=(name,)) for name in "abcd"]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    context.shutdown()
    (file,) = tmp_path.glob("*.log")
    lines = [line.partition("]: ")[2] for line in file.read_text().splitlines()]
    assert sorted(lines) == sorted(f"{name}{number}" * 20 for name in "abcd" for number in range(200))
