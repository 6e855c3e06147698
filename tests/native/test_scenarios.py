"""Real rclpy does the same with never-compiled classes as with compiled ones, in the scenarios of against_rclpy.

Those scenarios show that the local transport prints the same as Jazzy's rclpy with compiled classes. On Jazzy, the
local transport's output is therefore the expected one; elsewhere it is the output with compiled classes. `rclpy`
keeps the compiled packages that its own C code reads.
"""

from __future__ import annotations

import importlib.util
import re
import sys
from pathlib import Path

import pytest

from .support import DISTRIBUTION, ROOT, needs_rclpy, never_compiled

_SPEC = importlib.util.spec_from_file_location(
    "native_harness", ROOT / "tests" / "against_rclpy" / "harness.py"
)
assert _SPEC is not None and _SPEC.loader is not None
harness = importlib.util.module_from_spec(_SPEC)
sys.modules[_SPEC.name] = harness  # dataclasses look their module up
_SPEC.loader.exec_module(harness)

PACKAGES = ("geometry_msgs", "sensor_msgs", "std_msgs", "std_srvs", "test_msgs")
_USES_THEM = re.compile(rf"^ *from ({'|'.join(PACKAGES)})\.", re.MULTILINE)
SCENARIOS = [path for path in sorted(harness.SCENARIOS.glob("*.py")) if _USES_THEM.search(path.read_text())]
SOME = {"action_goals", "comm_types_and_waiting", "node_parameters"}

_ADDRESS = re.compile(r" at 0x[0-9a-f]+")
# An invalid goal identifier fails when it is encoded, with the codec's error, not when it is first used.
_ITS_OWN_ERRORS = re.compile(r"^goal_uuid .*\n", re.MULTILINE)

pytestmark = needs_rclpy


@pytest.fixture(scope="module")
def packages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The packages of the programs, as in a user's `generated/`."""
    return never_compiled(tmp_path_factory.mktemp("scenarios") / "generated", PACKAGES)


def test_the_classes_are_the_never_compiled_ones(packages: Path, tmp_path: Path) -> None:
    scenario = tmp_path / "whose.py"
    scenario.write_text(
        "def main():\n"
        "    from rcl_interfaces.msg import Log\n"
        "    from test_msgs.action import Fibonacci\n"
        "    print(hasattr(Fibonacci, '__type_hash__'), hasattr(Log, '__type_hash__'))\n"
    )
    assert harness.run(scenario, ours=False, before=packages).transcript == "True False\n"


@pytest.mark.timeout(5 * harness.TIME_LIMIT)
@pytest.mark.parametrize(
    "scenario",
    [path if path.stem in SOME else pytest.param(path, marks=pytest.mark.slow) for path in SCENARIOS],
    ids=lambda path: path.stem,
)
def test_prints_the_same(scenario: Path, packages: Path) -> None:
    expected = harness.run(scenario, ours=DISTRIBUTION == "jazzy")
    if DISTRIBUTION == "jazzy":
        assert expected.exit_code == 0, expected.errors
    # Real discovery is sometimes late on a busy machine; a difference in every run is real.
    for _ in range(3):
        real = harness.run(scenario, ours=False, before=packages)
        if outcome(real) == outcome(expected):
            return
    assert outcome(real) == outcome(expected), real.errors


def outcome(run: harness.Outcome) -> tuple[int | None, str]:
    """The parts of the outcome that must be the same."""
    return run.exit_code, _ADDRESS.sub("", _ITS_OWN_ERRORS.sub("", run.transcript))
