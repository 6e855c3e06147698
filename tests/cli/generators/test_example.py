"""examples/generators: a package that pip installs, and a program in another language."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from ifgen.pipeline.generators import find

from ..conftest import Run, write

SOURCE = Path(__file__).parents[3] / "examples/generators/ros-csv"


@pytest.mark.slow
def test_pip_installs_it_and_ifgen_finds_it(tmp_path: Path) -> None:
    shutil.copytree(SOURCE, tmp_path / "ros-csv")  # a build leaves files there
    site = tmp_path / "site"
    pip = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--no-deps",
        "--no-index",
        "--no-build-isolation",
    ]
    subprocess.run([*pip, "--target", str(site), str(tmp_path / "ros-csv")], check=True, timeout=120)
    write(tmp_path / "interfaces/a_msgs/msg/Dot.msg", "float64 x 1.5 # how far [m]\nuint8 n\n")
    write(
        tmp_path / "pyproject.toml",
        '[tool.ifgen]\npaths = ["interfaces"]\npython = false\n'
        '[tool.ifgen.generate.fields]\nuse = "csv"\nout = "docs"\noptions = { delimiter = ";" }\n',
    )
    environment = {**os.environ, "PYTHONPATH": str(site)}
    run = [sys.executable, "-m", "ifgen"]
    done = subprocess.run(
        [*run, "generate"], env=environment, capture_output=True, text=True, timeout=60, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "docs: 1 file written\n", "")
    assert (tmp_path / "docs/fields.csv").read_text() == (
        "type;field;of;unit;default;bytes;comment\n"
        "a_msgs/msg/Dot;x;float64;m;1.5;9;how far\n"
        "a_msgs/msg/Dot;n;uint8;;;9;\n"
    )
    listed = subprocess.run(
        [*run, "generators", "list"], env=environment, capture_output=True, text=True, timeout=60, check=True
    )
    assert "csv            one table of all fields, for spreadsheets (ros-csv 1.0)\n" in listed.stdout


PERL = SOURCE.with_name("perl")


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("perl") is None, reason="perl is not installed")
def test_the_program_passes_the_kit_and_the_suite(ifgen: Run, tmp_path: Path) -> None:
    shutil.copy(PERL / "generate.pl", tmp_path)
    done = ifgen("generators", "test", "--command", "perl generate.pl")
    assert (done.code, done.err) == (0, "")
    assert done.out in (PERL / "README.md").read_text()
    root = SOURCE.parents[2]
    text = (PERL / "pyproject.toml").read_text()
    ours = '"../../../interfaces/sensor_msgs"'
    assert ours in text
    suite = [str(root / "interfaces"), str(root / "tests/conformance/interfaces")]
    write(tmp_path / "pyproject.toml", text.replace(f"[{ours}]", json.dumps(suite)))
    assert ifgen("generate").code == 0
    testee = [sys.executable, "-m", "ifgen", "conformance", "--", "perl", "-Ilib", str(PERL / "testee.pl")]
    judged = subprocess.run(testee, capture_output=True, text=True, timeout=280, check=False)
    assert judged.returncode == 0, judged.stdout
    [passed] = re.findall(r"^all +(\S+) ", judged.stdout, re.MULTILINE)
    assert f"all {passed} cases" in (PERL / "README.md").read_text()


def test_it_passes_the_kit(ifgen: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    info = tmp_path / "site/ros_csv-1.0.dist-info"
    write(info / "METADATA", "Metadata-Version: 2.1\nName: ros-csv\nVersion: 1.0\n")
    write(info / "entry_points.txt", "[ifgen.generators]\ncsv = ros_csv:GENERATOR\n")
    monkeypatch.syspath_prepend(SOURCE)
    monkeypatch.syspath_prepend(tmp_path / "site")
    find.installed.cache_clear()
    try:
        done = ifgen("generators", "test", "csv")
        assert (done.code, done.out, done.err) == (0, "csv: 1 file, no mistakes\n", "")
    finally:
        find.installed.cache_clear()
