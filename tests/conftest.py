"""What all tests share: nodes that nobody else hears, and examples that are the same on every machine.

The nodes that tests start are heard by nobody else on this machine or beyond it.
"""

import os
import signal
from contextlib import ExitStack

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers
from ifgen_pytest.domains import own_domain

_kept = ExitStack()  # until this process ends
os.environ["ROS_DOMAIN_ID"] = str(_kept.enter_context(own_domain()))
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"

# Shells let programs in the background ignore Ctrl-C, and their children with them, which tests of Ctrl-C start.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# A machine that is busy with something else is slow, but not wrong, and what fails there must fail elsewhere too.
# Fixtures of functions are shared by all examples of a test, which is what is meant here.
settings.register_profile(
    "ifgen",
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[check for check in HealthCheck if check is not HealthCheck.filter_too_much],
)
settings.load_profile("ifgen")

# It would also draw constants from the sources of whatever modules of ours are imported by then: other examples in
# each process, and after each edit. There is no public switch for that; test_drawn.py notices if this is none.
providers._get_local_constants = providers.Constants


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """What `-n auto` means here: more workers than cores, because many tests wait for other processes."""
    return 2 * (os.cpu_count() or 1)
