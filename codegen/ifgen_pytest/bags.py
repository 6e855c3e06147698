"""The fixtures `bag`, `record` and `replay`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from importlib.util import find_spec
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from ifgen_runtime.bag import Bag

    from ifgen_pytest.recording import Recording
    from ifgen_pytest.replayed import Replayed

# Late imports: pytest loads the plugin in projects too that never use it.

FOLDER = "ros_bags"
"""The setting of where the bags of tests that fail are kept."""

RECORDING = pytest.StashKey["Recording"]()
"""Where a test keeps its recording for the hooks."""


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
