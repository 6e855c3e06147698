"""`--transport` from a project's point of view: pytest runs pytest in processes of their own."""

from __future__ import annotations

from pathlib import Path

import ifgen
import pytest

from .support import needs_rclpy

pytest_plugins = ("pytester",)

WHICH = """
import rclpy

def test_which():
    print("rclpy is", "ours" if "underlay" in rclpy.__file__ else "real")
"""


@pytest.fixture(autouse=True)
def _no_settings_of_this_run(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("PYTEST_ADDOPTS", "PYTEST_XDIST_WORKER", "PYTEST_XDIST_WORKER_COUNT"):
        monkeypatch.delenv(name, raising=False)


def test_local_is_ours_even_for_what_conftests_import(pytester: pytest.Pytester) -> None:
    pytester.makeconftest("import rclpy\nassert 'underlay' in rclpy.__file__")
    pytester.makepyfile(WHICH)
    result = pytester.runpytest_subprocess("-s", "--transport", "local")
    result.assert_outcomes(passed=1)
    result.stdout.fnmatch_lines(["transport: local", "*rclpy is ours*"])


@needs_rclpy
@pytest.mark.parametrize("transport", ["rclpy", pytest.param("auto", marks=pytest.mark.slow)])
def test_real_one(pytester: pytest.Pytester, transport: str) -> None:
    pytester.makepyfile(WHICH)
    result = pytester.runpytest_subprocess("-s", f"--transport={transport}")
    result.assert_outcomes(passed=1)
    result.stdout.fnmatch_lines(["transport: rclpy", "*rclpy is real*"])


def test_setting_of_the_project_and_option_before_it(pytester: pytest.Pytester) -> None:
    pytester.makepyprojecttoml('[tool.pytest.ini_options]\ntransport = "local"')
    pytester.makepyfile(WHICH)
    pytester.runpytest_subprocess("-s").stdout.fnmatch_lines(["*rclpy is ours*"])
    pytester.makepyprojecttoml('[tool.pytest.ini_options]\ntransport = "rclpy"')
    pytester.runpytest_subprocess("-s", "--transport=local").stdout.fnmatch_lines(["*rclpy is ours*"])


def test_wrong_words_are_told(pytester: pytest.Pytester) -> None:
    result = pytester.runpytest_subprocess("--transport=zenoh")
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines(["*--transport*zenoh*"])
    pytester.makepyprojecttoml('[tool.pytest.ini_options]\ntransport = "zenoh"')
    result = pytester.runpytest_subprocess()
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines(["*transport must be one of local, rclpy, auto, both, not 'zenoh'*"])


@needs_rclpy
def test_both_runs_twice_and_reports_the_worst(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(WHICH + "    assert 'underlay' in rclpy.__file__\n")
    result = pytester.runpytest_subprocess("-s", "--transport", "both", "-k", "which")
    assert result.ret == pytest.ExitCode.TESTS_FAILED
    result.stdout.fnmatch_lines(
        [
            *("transport local", "*rclpy is ours*", "transport rclpy", "*rclpy is real*"),
            *("both transports", "  local: passed", "  rclpy: exit code 1"),
        ]
    )
    assert result.stdout.str().count("1 passed in") == result.stdout.str().count("1 failed in") == 1


@pytest.mark.slow
def test_both_where_there_is_no_real_one(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(WHICH)
    pytester.makeconftest("import rclpy  # also where nothing but the local transport has one")
    # Stands in for a machine without ROS: only our packages are found.
    pytester.mkpydir("without_ros")
    pytester.path.joinpath("without_ros", "__init__.py").write_text(
        "import ifgen.activation as a\nfinds = a._finds\n"
        "a._finds = lambda name, path: name != 'rclpy' and finds(name, path)\n"
    )
    result = pytester.runpytest_subprocess("-p", "without_ros", "-s", "--transport=both")
    assert result.ret == pytest.ExitCode.USAGE_ERROR, "half of what was asked for did not happen"
    result.stdout.fnmatch_lines(
        ["*rclpy is ours*", "  local: passed", "  rclpy: did not run: there is no real rclpy*"]
    )


def test_nothing_happens_unless_asked(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        """
        import sys

        def test_path():
            assert not any("underlay" in entry or entry.endswith("generated") for entry in sys.path)
            assert not {"rclpy", "rmw_local", "ifgen.activation", "jinja2"} & set(sys.modules)
        """
    )
    result = pytester.runpytest_subprocess("-W", "error")
    result.assert_outcomes(passed=1)
    result.stdout.no_fnmatch_line("*transport*")


@pytest.mark.slow
def test_what_the_project_brings_wins_over_our_examples(pytester: pytest.Pytester) -> None:
    pytester.mkpydir("teleop").joinpath("__init__.py").write_text("SPEED = 3")
    pytester.makepyprojecttoml('[tool.pytest.ini_options]\ntransport = "local"\npythonpath = ["."]')
    pytester.makepyfile("import rclpy\nfrom teleop import SPEED\ndef test(): assert SPEED == 3")
    pytester.runpytest_subprocess().assert_outcomes(passed=1)


@pytest.mark.slow
def test_hint_where_a_transport_is_missing(pytester: pytest.Pytester) -> None:
    """The hint appears wherever a test imports a package that is not on the path."""
    (pytester.mkdir("ws") / "mine_msgs/msg").mkdir(parents=True)
    (pytester.path / "ws/mine_msgs/msg/One.msg").write_text("int32 x\n")
    ifgen.generate(pytester.path / "ws", output=pytester.path / "out")
    pytester.makepyprojecttoml('[tool.ifgen]\npaths = ["ws"]\noutput = "out"\n')
    pytester.makepyfile(
        test_module="import mine_msgs.msg\ndef test(): pass",
        test_inside="def test():\n    from mine_msgs.msg import One",
        test_other="import nobody_has_this",
    )
    said = pytester.runpytest_subprocess("test_module.py", "test_other.py").stdout
    said.fnmatch_lines(
        ["*ERROR collecting test_module.py*", "*'mine_msgs' is in out: run `pytest --transport local`*"]
    )
    assert said.str().count("pytest --transport local") == 1, "a hint for what it does not help"
    said = pytester.runpytest_subprocess("test_inside.py").stdout
    said.fnmatch_lines(
        ["*No module named 'mine_msgs'*", "*'mine_msgs' is in out: run `pytest --transport local`*"]
    )
    pytester.makeconftest("import mine_msgs")
    said = pytester.runpytest_subprocess("test_inside.py").stderr
    said.fnmatch_lines(
        ["*No module named 'mine_msgs'", "*'mine_msgs' is in out: run `pytest --transport local`*"]
    )
    pytester.runpytest_subprocess("--transport=local", "test_module.py", "test_inside.py").assert_outcomes(
        passed=2
    )


@pytest.mark.slow
def test_option_of_the_same_name_in_a_project_stays_its_own(pytester: pytest.Pytester) -> None:
    pytester.makeconftest("def pytest_addoption(parser):\n    parser.addoption('--transport', default='tcp')")
    pytester.makepyfile("def test_own(request):\n    assert request.config.getoption('transport') == 'udp'")
    pytester.runpytest_subprocess("--transport=udp").assert_outcomes(passed=1)


@pytest.mark.slow
def test_workers_of_xdist_take_part(pytester: pytest.Pytester) -> None:
    pytest.importorskip("xdist")
    pytester.makepyfile(WHICH + "    assert 'underlay' in rclpy.__file__\n")
    pytester.runpytest_subprocess("-n1", "--transport=local").assert_outcomes(passed=1)


def test_what_the_project_has_generated_is_found(pytester: pytest.Pytester) -> None:
    """Messages and nodes in the output folder of [tool.ifgen], as for `ifgen run`."""
    folder = pytester.mkdir("ws") / "mine/nodl"
    folder.mkdir(parents=True)
    (folder / "one.nodl.yaml").write_text("nodl_version: 2\n")
    pytester.makepyprojecttoml('[tool.ifgen]\npaths = ["ws"]\noutput = "out"\n')
    ifgen.generate(pytester.path / "ws", output=pytester.path / "out")
    file = pytester.makepyfile("from mine.one import One\ndef test_it(ros_node):\n    ros_node(One)")
    pytester.runpytest_subprocess("--transport", "local", file).assert_outcomes(passed=1)
    pytester.makepyprojecttoml("[tool.ifgen]\nnope = 1\n")
    result = pytester.runpytest_subprocess("--transport", "local")
    assert result.ret == pytest.ExitCode.USAGE_ERROR


GENERATED = Path(__file__).resolve().parents[2] / "generated"


@pytest.mark.parametrize(
    ("missing", "line"),
    [
        ("rclpy", "ifgen: 1 file skipped: there is no rclpy: source ROS, or add --transport local"),
        ("hypothesis", "ifgen: 1 file skipped: hypothesis is missing, of the extra `test`: run `*[[]test]*"),
    ],
)
def test_the_reason_for_skipped_tests_is_shown(pytester: pytest.Pytester, missing: str, line: str) -> None:
    """Without -rs, and once for each reason."""
    tests = next(GENERATED.glob("std_srvs/test/test_*_interfaces.py")).read_text(encoding="utf-8")
    needs = [line for line in tests.splitlines() if line.startswith("pytest.importorskip(")]
    pytester.makepyfile(
        "\n".join(["import sys", "import pytest", f"sys.modules[{missing!r}] = None", *needs])
    )
    ran = pytester.runpytest_inprocess("-p", "no:hypothesispytest")
    ran.stdout.fnmatch_lines([line, "*1 skipped*"])
