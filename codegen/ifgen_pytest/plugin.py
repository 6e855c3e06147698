"""The hooks of pytest: the option, the marker, and the work around each strict test."""

from __future__ import annotations

import os
from collections.abc import Generator
from typing import Any

import pytest

from ifgen_pytest import launch_tests, transport
from ifgen_pytest.comparison import explain
from ifgen_pytest.domains import RANGE
from ifgen_pytest.fixtures import (
    FOLDER,
    RECORDING,
    bag,
    check_system,
    ifgen_generator,
    record,
    replay,
    ros_collect,
    ros_context,
    ros_executor,
    ros_lockstep,
    ros_node,
    ros_virtual_clock,
)
from ifgen_pytest.launch_tests import pytest_pycollect_makemodule
from ifgen_pytest.strict import StrictCheck

__all__ = [
    "bag",
    "check_system",
    "ifgen_generator",
    "pytest_pycollect_makemodule",
    "record",
    "replay",
    "ros_collect",
    "ros_context",
    "ros_executor",
    "ros_lockstep",
    "ros_node",
    "ros_virtual_clock",
]

_TRANSPORT = pytest.StashKey[str]()
_CHECK = pytest.StashKey[StrictCheck]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare the settings; `--transport` follows once all conftests had their say."""
    parser.addini("transport", "where rclpy comes from: local, rclpy, auto or both", default="")
    parser.addini("ros_strict", "apply the marker ros_strict to every test", "bool", default=False)
    parser.addini(FOLDER, "the folder for the bags of tests that fail", default="")
    group = parser.getgroup("ifgen")
    group.addoption("--update-golden", action="store_true", help="accept what generators make now")
    group.addoption("--ros-strict", action="store_true", help="apply the marker ros_strict to every test")
    group.addoption(
        "--ros-bags",
        metavar="FOLDER",
        help="keep the bags of tests that fail here, not in a temporary folder",
    )


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_load_initial_conftests(
    early_config: pytest.Config, parser: pytest.Parser, args: list[str]
) -> Generator[None, None, None]:
    """Choose the transport before anything of the project is imported, which may import rclpy."""
    wanted = transport.asked(early_config, args)
    if wanted is not None:
        # This process runs no test for `both`, but pytest imports its conftests.
        chosen = transport.activate("auto" if wanted == "both" else wanted, args)
        early_config.stash[_TRANSPORT] = wanted if wanted == "both" else chosen
        if chosen == "local" and wanted != "both":
            os.environ.setdefault(RANGE, "OFF")  # tests hear nobody outside, unless they are told to
    try:
        yield
    except Exception as error:
        cause = getattr(error, "cause", None)  # of a conftest that cannot be imported
        if wanted is None and isinstance(cause, Exception) and (advice := transport.hint(cause)):
            cause.add_note(f"ifgen: {advice}")
        raise
    transport.add_option(parser)
    launch_tests.add_option(parser)


def pytest_configure(config: pytest.Config) -> None:
    """Declare the markers."""
    config.addinivalue_line("markers", "launch_test: on generate_test_description, for tests of launches")
    config.addinivalue_line(
        "markers",
        "ros_strict: fail on exceptions in callbacks, leaked nodes, undelivered messages, incompatible QoS "
        "and synchronous calls that cannot be answered",
    )


@pytest.hookimpl(tryfirst=True)
def pytest_cmdline_main(config: pytest.Config) -> int | None:
    """Run everything twice if both transports are asked for."""
    informs = config.option.help or config.option.version
    if informs or config.stash.get(_TRANSPORT, None) != "both":
        return None
    return transport.run_on_both(config)


def pytest_report_header(config: pytest.Config) -> list[str]:
    """Tell the transport."""
    chosen = config.stash.get(_TRANSPORT, None)
    return [] if chosen is None else [f"transport: {chosen}"]


def pytest_assertrepr_compare(op: str, left: object, right: object) -> list[str] | None:
    """Name the fields in which messages or replays differ."""
    return explain(left, right) if op == "==" else None


def pytest_exception_interact(node: pytest.Item | pytest.Collector, call: Any, report: Any) -> None:
    """Say what brings a module that is missing."""
    asked = node.config.stash.get(_TRANSPORT, None) is not None
    if not asked and call.excinfo is not None and (advice := transport.hint(call.excinfo.value)):
        report.sections.append(("ifgen", advice))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say why generated tests were skipped: pytest itself says so with -rs only."""
    for line in transport.skips(terminalreporter.stats.get("skipped", ())):
        terminalreporter.write_line(line)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: Any
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Keep the bag of a test that fails, and say where it is."""
    report = yield
    if (recording := item.stash.get(RECORDING, None)) is not None:
        recording.note(report)
    return report


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> Generator[None, None, None]:
    """Watch from before the first fixture on."""
    everywhere = item.config.getoption("ros_strict") or item.config.getini("ros_strict")
    if everywhere or item.get_closest_marker("ros_strict"):
        item.stash[_CHECK] = StrictCheck()
    yield


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, None, None]:
    """Let a callback's exception fail the test."""
    yield
    if (check := item.stash.get(_CHECK, None)) is not None and (problems := check.errors()):
        pytest.fail(problems, pytrace=False)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_teardown(item: pytest.Item) -> Generator[None, None, None]:
    """Report what is left when every fixture is gone."""
    check = item.stash.get(_CHECK, None)
    if check is None:
        yield
        return
    try:
        yield
    finally:
        check.end()
        del item.stash[_CHECK]
    if problems := "\n".join(filter(None, (check.errors(), check.left_over()))):
        pytest.fail(problems, pytrace=False)
