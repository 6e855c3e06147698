"""The fixtures. rclpy is imported when a test asks for one, and never before."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, nullcontext
from functools import partial
from importlib.util import find_spec
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from ifgen_pytest.collector import CollectorFactory, NodeFactory
from ifgen_pytest.domains import RANGE, own_domain, private_domain

if TYPE_CHECKING:
    from ifgen_runtime.bag import Bag
    from rclpy.context import Context
    from rclpy.executors import SingleThreadedExecutor

    from ifgen_pytest.recording import Recording
    from ifgen_pytest.replaying import Replayed

# Late imports: projects that never use the plugin load it too, and rclpy is that of the chosen transport.

FOLDER = "ros_bags"
"""The setting of where the bags of tests that fail are kept."""

RECORDING = pytest.StashKey["Recording"]()
"""Where a test keeps its recording for the hooks."""


@pytest.fixture
def check_system(request: pytest.FixtureRequest) -> Callable[..., Any]:
    """Fails if the system of a launch file is not sound: `check_system("bringup.launch.py", complete=True)`.

    It is `ifgen check --system` with a path relative to the test's file. It returns the system.
    """
    from ifgen.command_kit.system import extension

    return partial(extension("test"), folder=request.path.parent)


@pytest.fixture
def ros_context(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[Context]:
    """The default context, initialised in its own domain and shut down at the end.

    `rclpy.spin` and nodes that are made without a `context` use it.
    """
    if "ros_virtual_clock" in request.fixturenames:
        request.getfixturevalue("ros_virtual_clock")  # time has to stand still before anything waits in it
    import rclpy
    from rclpy.signals import SignalHandlerOptions

    real = find_spec("rmw_local") is None
    if not real:
        monkeypatch.setenv(RANGE, "OFF")  # a private domain is private only within this process
    elif RANGE not in os.environ:
        monkeypatch.setenv(RANGE, "LOCALHOST")
    with own_domain() if real else nullcontext(private_domain()) as domain:
        # No signal handlers: Ctrl-C is pytest's.
        rclpy.init(args=[], domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
        yield rclpy.get_default_context()
        rclpy.try_shutdown()


@pytest.fixture
def ros_executor(ros_context: Context) -> Iterator[SingleThreadedExecutor]:
    """A SingleThreadedExecutor of `ros_context`, shut down at the end. The test spins it."""
    from rclpy.executors import SingleThreadedExecutor

    executor = SingleThreadedExecutor(context=ros_context)
    yield executor
    executor.shutdown()


@pytest.fixture
def ros_node(ros_executor: SingleThreadedExecutor) -> Iterator[NodeFactory]:
    """Makes nodes in `ros_executor`, destroyed at the end: `ros_node("name")` or `ros_node(MyNode, ...)`."""
    factory = NodeFactory(ros_executor)
    yield factory
    factory.destroy()


@pytest.fixture
def ros_collect(ros_executor: SingleThreadedExecutor, ros_node: NodeFactory) -> CollectorFactory:
    """Makes collectors of messages: `ros_collect(String, "chatter").wait(3)`."""
    return CollectorFactory(ros_executor, ros_node)


@pytest.fixture
def ros_lockstep() -> Callable[..., Any]:
    """`rmw_local.lockstep.run`: calls functions, each in a process, in one virtual time (local only)."""
    try:
        from rmw_local.lockstep import run
    except ImportError:
        pytest.skip("lockstep needs the local transport: run pytest with --transport local")
    return run


@pytest.fixture
def ros_virtual_clock(request: pytest.FixtureRequest) -> Iterator[Any]:
    """The whole test in virtual time, on the local transport only; the value is its VirtualDriver.

    Parametrise it indirectly with seeds to try other orders of threads.
    """
    try:
        from rmw_local.virtual_time import virtual_time
    except ImportError:
        pytest.skip("virtual time needs the local transport: run pytest with --transport local")
    with virtual_time(seed=getattr(request, "param", 0)) as driver:
        yield driver


@pytest.fixture
def bag(request: pytest.FixtureRequest) -> Iterator[Callable[..., Bag]]:
    """Opens bags: `bag("walk.mcap")["/imu"]`. Paths are relative to the test's file; damage is an error."""
    from ifgen_runtime.bag import Bag

    with ExitStack() as opened:

        def open_bag(path: str | PathLike[str], **options: Any) -> Bag:
            return opened.enter_context(Bag(request.path.parent / path, **{"strict": True, **options}))

        yield open_bag


@pytest.fixture
def record(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Recording]:
    """Records what the test's nodes publish. A test that fails leaves the bag, and says where."""
    if "ros_virtual_clock" in request.fixturenames:
        request.getfixturevalue("ros_virtual_clock")  # so that it is the clock of the recording, too
    from ifgen_pytest.recording import Recording, file_name

    recording = Recording(_folder(request.config, tmp_path_factory) / file_name(request.node.nodeid))
    request.node.stash[RECORDING] = recording
    with recording.running():
        yield recording


def _folder(config: pytest.Config, temporary: pytest.TempPathFactory) -> Path:
    wanted = config.getoption(FOLDER) or config.getini(FOLDER)
    if not wanted:
        return temporary.mktemp("bag")
    folder = config.rootpath / str(wanted)
    folder.mkdir(parents=True, exist_ok=True)
    return folder


@pytest.fixture
def replay(request: pytest.FixtureRequest) -> Callable[..., Replayed]:
    """Sends a bag through nodes, in virtual time: `replay("walk.mcap", Balance)["/cmd"]`.

    `ifgen_pytest.replaying.replay` with paths relative to the test's file.
    """
    if find_spec("rmw_local") is None:
        pytest.skip("a replay needs the local transport: run pytest with --transport local")
    from ifgen_pytest.replaying import replay as replay_through

    def replay_beside(path: str | PathLike[str], *nodes: Any, **options: Any) -> Replayed:
        return replay_through(request.path.parent / path, *nodes, **options)

    return replay_beside


@pytest.fixture
def ifgen_generator(request: pytest.FixtureRequest) -> Callable[..., None]:
    """`ifgen_generator("acme-docs", golden=FOLDER)` tests a generator, as `ifgen generators test` does.

    With `command=` it is a program. `options` is a table of its options. `--update-golden` accepts all files.
    """

    def check(
        name: str = "",
        *,
        command: str = "",
        golden: PathLike[str] | None = None,
        options: Mapping[str, object] | None = None,
    ) -> None:
        arguments = [sys.executable, "-m", "ifgen", "generators", "test", *([name] if name else [])]
        arguments += ["--command", command] if command else []
        arguments += ["--golden", os.fspath(golden)] if golden is not None else []
        arguments += ["--options", json.dumps(options or {})]
        if request.config.getoption("--update-golden") and golden is not None:
            arguments.append("--update")
        done = subprocess.run(arguments, capture_output=True, text=True, check=False)
        if done.returncode:
            pytest.fail(done.stderr or done.stdout, pytrace=False)

    return check
