"""A fork does not wait for a thread that it does not have: neither for its locks nor for its imports."""

from __future__ import annotations

import ast
import os
import signal
import threading
import warnings
from collections.abc import Iterator
from importlib.util import resolve_name
from pathlib import Path
from typing import Any

import pytest
import rclpy
import rmw_local
from rclpy.impl import program
from rclpy.impl.rcl import handle
from rmw_local.domain import Domain

if not hasattr(os, "fork"):
    pytest.skip("this system cannot fork", allow_module_level=True)

ROOM = Path(rmw_local.__file__).parent
# A virtual clock keeps a program apart, so no thread of a transport imports what it needs. numpy is imported where
# a program asks for arrays.
NOT_OF_THREADS = (
    "rmw_local.lockstep.",
    "rmw_local.cooperative",
    "ifgen_runtime.views",
    "rmw_local.transports.discovery",
)


@pytest.fixture
def node() -> Iterator[rclpy.node.Node]:
    rclpy.init()
    node = rclpy.create_node("parent")
    node.get_logger().info("has a log file")
    yield node
    rclpy.shutdown()


def _locks(node: rclpy.node.Node) -> dict[str, Any]:
    here, domain = program.current(), node.context.handle.participant.domain
    return {
        "the program": here.lock,
        "levels of loggers": here.logging.levels._lock,
        "the log file": here.logging.file._lock,
        "/rosout": here.rosout.lock,
        "its writer": here.rosout.writers["parent"]._lock,
        "logging": rclpy.context.g_logging_configure_lock,
        "handles": handle._ending,
        "domains": Domain._creation,
        "the domain": domain.lock,
    }


def _live_in_a_fork(parent: rclpy.node.Node) -> None:
    rclpy.shutdown()
    rclpy.init()
    node = rclpy.create_node("parent")
    node.get_logger().info("in the fork")
    parent.destroy_node()
    rclpy.shutdown()


@pytest.mark.parametrize(
    "held",
    [
        "the program",
        "levels of loggers",
        "the log file",
        "/rosout",
        "logging",
        "handles",
        "domains",
        "the domain",
    ],
)
def test_no_lock_stays_held_in_a_fork(node: rclpy.node.Node, held: str) -> None:
    lock, taken, over = _locks(node)[held], threading.Event(), threading.Event()

    def hold() -> None:
        with lock:
            taken.set()
            over.wait()

    thread = threading.Thread(target=hold)
    thread.start()
    taken.wait()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # Python 3.12 warns of threads
        child = os.fork()
    if not child:
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(10)
        code = 1
        try:
            _live_in_a_fork(node)
            code = 0
        finally:
            os._exit(code)
    over.set()
    thread.join()
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def _late_imports(path: Path) -> Iterator[str]:
    package = ".".join(path.relative_to(ROOM.parent).parent.parts)
    for function in ast.walk(ast.parse(path.read_text())):
        if isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef):
            for statement in ast.walk(function):
                if isinstance(statement, ast.ImportFrom):
                    module = resolve_name("." * statement.level + (statement.module or ""), package)
                    for alias in statement.names:
                        is_module = (
                            (ROOM.parent / f"{module}.{alias.name}".replace(".", "/"))
                            .with_suffix(".py")
                            .exists()
                        )
                        yield f"{module}.{alias.name}" if is_module else module
                elif isinstance(statement, ast.Import):
                    yield from (alias.name for alias in statement.names)


def test_all_that_threads_of_a_transport_import_late_is_loaded_before_a_fork(
    node: rclpy.node.Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    from rmw_local.transports import discovery

    late = {
        name for path in ROOM.rglob("*.py") if "lockstep" not in path.parts for name in _late_imports(path)
    }
    wanted = {name for name in late if not name.startswith(NOT_OF_THREADS)}
    assert "rmw_local.transports.link" in wanted
    loaded: list[str] = []
    monkeypatch.setattr(discovery, "import_module", loaded.append)
    monkeypatch.setattr(discovery.Discovery, "all", [object()])
    discovery._load()
    assert wanted <= set(loaded)


def test_a_program_that_reaches_nobody_loads_nothing_before_a_fork(monkeypatch: pytest.MonkeyPatch) -> None:
    from rmw_local.transports import discovery

    loaded: list[str] = []
    monkeypatch.setattr(discovery, "import_module", loaded.append)
    monkeypatch.setattr(discovery.Discovery, "all", [])
    discovery._load()
    assert loaded == []
