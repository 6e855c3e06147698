"""Set-up of all tests: nodes that nobody else hears, and examples that are the same on every machine.

No other process on this machine or beyond it hears the nodes that tests start.

Tests in folders called `inside` use rclpy in their own process, which has one rclpy only. So they run in sessions of
their own, with `--transport local` or, those of libraries, on either.
"""

import os
import signal
import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers
from ifgen_pytest.domains import own_domain

_kept = ExitStack()  # until this process ends
os.environ["ROS_DOMAIN_ID"] = str(_kept.enter_context(own_domain()))
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["IFGEN_OTHER_DOMAINS"] = "0"  # those of other tests, which tools would tell of

# Shells make background programs ignore Ctrl-C, and their children too, which tests of Ctrl-C start.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# A busy machine is slow, but not wrong, and a failure there must be a failure elsewhere too.
# All examples of a test share the fixtures of its function, which is intended here.
settings.register_profile(
    "ifgen",
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[check for check in HealthCheck if check is not HealthCheck.filter_too_much],
)
settings.load_profile("ifgen")

# Hypothesis would also draw constants from the sources of imported modules of ours: other examples in each process
# and after each edit. There is no public switch for that; test_drawn.py notices if this one stops working.
providers._get_local_constants = providers.Constants


_ROOT = Path(__file__).parents[1]


def pytest_configure(config: pytest.Config) -> None:
    """Let the programs that tests in `inside` start find the same rclpy, and log elsewhere."""
    if _transport(config) == "local":
        places = (_ROOT / "codegen/underlay", _ROOT / "generated", _ROOT / "codegen", _ROOT)
        os.environ["PYTHONPATH"] = os.pathsep.join(map(str, places))
        sys.path.append(str(_ROOT))  # which processes of a lockstep run inherit
        os.environ["ROS_LOG_DIR"] = _kept.enter_context(tempfile.TemporaryDirectory(prefix="ifgen-logs-"))


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Leave `inside` to sessions with a transport. Raise UsageError if this one was asked for its tests."""
    if collection_path.name != "inside" or _transport(config):
        return None
    if any("inside" in Path(word.partition("::")[0]).parts for word in config.args):
        raise pytest.UsageError(f"the tests in {collection_path} need a transport: add `--transport local`")
    return True


def _transport(config: pytest.Config) -> str:
    return config.getoption("transport", None) or ""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """The meaning of `-n auto` here: more workers than cores, because many tests wait for other processes."""
    return 2 * (os.cpu_count() or 1)
