"""Set-up of all tests: nodes that nobody else hears, and examples that are the same on every machine.

No other process on this machine or beyond it hears the nodes that tests start.
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


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """The meaning of `-n auto` here: more workers than cores, because many tests wait for other processes."""
    return 2 * (os.cpu_count() or 1)
