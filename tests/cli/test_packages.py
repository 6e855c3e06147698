"""`ifgen run PACKAGE NODE` and `ifgen test PACKAGE`: packages by name."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from ifgen.diagnostics import UsageError
from ifgen_tools.running import packages
from ifgen_tools.running.run import split

from .conftest import Run, write

GENERATED = Path(__file__).resolve().parents[2] / "generated"
SETUP = """from setuptools import setup
setup(name="my_pkg", entry_points={"console_scripts": ["talker = my_pkg.talker:main", "other=my_pkg.other:run"]})
"""


@pytest.fixture
def sources(tmp_path: Path) -> Path:
    """The sources of my_pkg in src, as `ros2 pkg create` makes them."""
    folder = tmp_path / "src/my_pkg"
    write(folder / "package.xml", "<package format='3'><name>my_pkg</name></package>")
    write(folder / "setup.py", SETUP)
    write(folder / "my_pkg/__init__.py", "")
    write(
        folder / "my_pkg/talker.py",
        "import sys\ndef main():\n    print('talks', sys.argv[1:])\n    return 3\n",
    )
    return folder


def test_a_node_of_a_generated_package_is_its_file() -> None:
    words = split(["battery_monitor", "battery_monitor", "a", ":", "-m", "b"], GENERATED)
    file = GENERATED / "battery_monitor/battery_monitor/battery_monitor.py"
    assert words == [[str(file), "a"], ["-m", "b"]]


def test_a_file_comes_before_a_package(tmp_path: Path) -> None:
    write(tmp_path / "battery_monitor", "")
    assert split(["battery_monitor", "battery_monitor"], GENERATED) == [
        ["battery_monitor", "battery_monitor"]
    ]


def test_a_node_of_sources_is_its_entry_point(sources: Path, tmp_path: Path) -> None:
    found = packages.find("my_pkg", tmp_path / "generated")
    assert found is not None
    assert (found.share, sorted(found.executables)) == (sources, ["other", "talker"])
    (words,) = split(["my_pkg", "talker", "--fast"], tmp_path / "generated")
    assert words == [
        *("-m", "ifgen_tools.running.entry_point", "talker", str(sources), "my_pkg.talker:main", "--fast")
    ]


def test_an_installed_share_is_no_source(tmp_path: Path) -> None:
    """A launch file of an installation finds what is installed with it, although a package.xml is near."""
    write(tmp_path / "share/ament_index/resource_index/packages/their_pkg", "")
    write(tmp_path / "share/their_pkg/package.xml", "<package format='3'><name>their_pkg</name></package>")
    file = write(tmp_path / "share/their_pkg/launch/their.launch.py", "")
    script = write(tmp_path / "lib/their_pkg/talker", "#!/usr/bin/env python3\n")
    script.chmod(0o755)
    found = packages.find("their_pkg", tmp_path / "generated", [file])
    assert found is not None
    assert (found.prefix, found.executables["talker"].words) == (tmp_path, (str(script),))


def test_an_installed_executable_is_found_by_the_index(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    prefix = tmp_path / "prefix"
    write(prefix / "share/ament_index/resource_index/packages/their_pkg", "")
    script = write(prefix / "lib/their_pkg/talker", "#!/usr/bin/env python3\n")
    binary = write(prefix / "lib/their_pkg/listener", "\x7fELF")
    for file in (script, binary):
        file.chmod(0o755)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(prefix))
    assert split(["their_pkg", "talker"], tmp_path) == [[str(script)]]
    with pytest.raises(UsageError) as raised:
        split(["their_pkg", "listener"], tmp_path)
    (found,) = raised.value.diagnostics
    assert found.message == "'listener' is no program in Python"
    assert found.help == f"start it by its path: {binary}"


@pytest.mark.parametrize(
    ("words", "message", "help"),
    [
        (
            ["battery_monitor"],
            "'battery_monitor' is a package: name one of its nodes, too",
            "it has battery_monitor",
        ),
        (
            ["battery_monitr", "a"],
            "there is no file or package 'battery_monitr'",
            "did you mean 'battery_monitor'?",
        ),
        (["battery_monitor", "batery"], "has no executable 'batery'", "it has battery_monitor"),
        (["nothing.py"], "there is no file 'nothing.py'", "to run a module, write `-m MODULE`"),
    ],
)
def test_mistakes(words: list[str], message: str, help: str) -> None:
    with pytest.raises(UsageError) as raised:
        split(words, GENERATED)
    (found,) = raised.value.diagnostics
    assert message in found.message
    assert help in (found.help or "")


def test_a_package_that_is_sources_is_suggested(sources: Path, tmp_path: Path) -> None:
    with pytest.raises(UsageError) as raised:
        packages.executable("my_pgk", "talker", tmp_path / "generated")
    (found,) = raised.value.diagnostics
    assert (found.help or "").startswith("did you mean 'my_pkg'? ifgen looked in ")


def test_packages_without_tests(ifgen: Run, sources: Path) -> None:
    missing = ifgen("test", "nothing_of_the_kind")
    assert (missing.code, missing.err.partition("\n")[0]) == (
        2,
        "error[no-package]: there is no package 'nothing_of_the_kind'",
    )
    untested = ifgen("test", "my_pkg")
    assert (untested.code, untested.err.partition("\n")[0]) == (
        2,
        "error[no-tests]: the package 'my_pkg' has no tests",
    )


@pytest.mark.slow
def test_packages_run_and_are_tested(sources: Path, tmp_path: Path) -> None:
    """The package itself can be imported, and others that are sources beside it."""
    write(sources.parent / "beside/package.xml", "<package format='3'><name>beside</name></package>")
    write(sources.parent / "beside/beside/__init__.py", "word = 'talks'")
    program = (
        "import sys\nfrom beside import word\ndef main():\n    print(word, sys.argv[1:])\n    return 3\n"
    )
    write(sources / "my_pkg/talker.py", program)
    tests = "import rclpy\nfrom my_pkg.talker import word\ndef test_a(): pass\ndef test_b(): assert 0\n"
    write(sources / "test/test_talker.py", tests)

    def ifgen(*words: str) -> tuple[int, str]:
        command = [sys.executable, "-m", "ifgen", *words]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
        return done.returncode, done.stdout

    assert ifgen("run", "--transport", "local", "my_pkg", "talker", "a") == (3, "talks ['a']\n")
    code, out = ifgen("test", "--transport", "local", "my_pkg", "-q")
    assert (code, "1 failed, 1 passed" in out) == (1, True)
    assert ifgen("test", "--transport", "local", "my_pkg", "-q", "-k", "test_a")[0] == 0
