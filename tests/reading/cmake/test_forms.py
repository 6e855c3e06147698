"""ifgen finds the interfaces that CMake passes to rosidl: each form of forms.txt, read by ifgen and run by CMake.

A form is a title (`====`), files (`----` and a path), and the interfaces that it lists (`>>>>`), or `refused`. Of those
that are `unclear` ifgen does not know the list, so it says so, and takes all that lies in msg. Listed files that are
missing from the files are created; SHARE is that of the package test_interface_files.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from ifgen.reading import interface_list
from ifgen.reading.storage import read_source

HERE = Path(__file__).parent
SHARE = Path(sys.prefix) / "share"
CMAKE = shutil.which("cmake")


@dataclass(frozen=True)
class Form:
    """A form: the files of a package, and the interfaces that it lists."""

    title: str
    files: dict[str, str]
    listed: tuple[str, ...]
    is_unclear: bool

    def write(self, root: Path) -> None:
        for name in (*self.files, *self.listed):
            if not name.startswith("SHARE") and name != "refused":
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(self.files.get(name, ""))

    def expected(self, root: Path) -> set[str]:
        other = SHARE / "test_interface_files"
        return {
            os.path.realpath(other / name.removeprefix("SHARE/") if name.startswith("SHARE") else root / name)
            for name in self.listed
        }


def forms() -> Iterator[Form]:
    for text in (HERE / "forms.txt").read_text().split("==== ")[1:]:
        title, _, rest = text.partition("\n")
        files, _, listed = rest.partition(">>>> ")
        parts = re.split(r"^---- (.*)\n", files, flags=re.MULTILINE)[1:]
        names = listed.split()
        is_unclear = names[:1] == ["unclear"]
        yield Form(
            title, dict(zip(parts[::2], parts[1::2], strict=True)), tuple(names[is_unclear:]), is_unclear
        )


FORMS = [pytest.param(form, id=form.title) for form in forms()]


def listed_in(root: Path) -> interface_list.InterfaceList:
    lies_there = sorted(root.glob("msg/*.msg"))
    listed = interface_list.of_source(root, read_source(root / "CMakeLists.txt"), lies_there, [SHARE])
    assert listed is not None
    return listed


@pytest.mark.parametrize("form", FORMS)
def test_form(form: Form, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    form.write(tmp_path)
    listed = listed_in(tmp_path)
    rules = {diagnostic.rule for diagnostic in listed.diagnostics} - {"unlisted-interface"}
    if form.listed == ("refused",):
        assert rules & {"missing-file", "unusual-path", "unclear-list"}
    else:
        assert rules == ({"unclear-list"} if form.is_unclear else set())
        assert {os.path.realpath(path) for path in listed.paths} == form.expected(tmp_path)
        assert listed.is_whole != form.is_unclear


needs_cmake = pytest.mark.skipif(
    CMAKE is None or not (SHARE / "rosidl_cmake").is_dir(), reason="needs cmake and rosidl"
)


def run_by_cmake(root: Path) -> subprocess.CompletedProcess[str]:
    arguments = (f"-DROOT={root}", f"-DROSIDL={SHARE / 'rosidl_cmake/cmake'}", "-P", HERE / "rosidl.cmake")
    environment = {**os.environ, "ROS_VERSION": "2", "ROS_DISTRO": "jazzy"}
    return subprocess.run(
        [str(CMAKE), *map(str, arguments)],
        env=environment,
        cwd=root,
        capture_output=True,
        text=True,
        check=False,
    )


@needs_cmake
@pytest.mark.parametrize("form", FORMS)
def test_cmake_agrees(form: Form, tmp_path: Path) -> None:
    """CMake, run up to rosidl's own `rosidl_generate_interfaces`, finds the same interfaces."""
    form.write(tmp_path)
    done = run_by_cmake(tmp_path)
    if form.listed == ("refused",):
        assert done.returncode != 0
        assert "rosidl_generate_interfaces" in done.stderr
        return
    assert done.returncode == 0, done.stderr
    files = {os.path.realpath(line[5:]) for line in done.stderr.splitlines() if line.startswith("FILE ")}
    assert files == form.expected(tmp_path)


def rows() -> Iterator[list[str]]:
    page = (HERE.parents[2] / "docs/rosidl-differences.md").read_text()
    section = page.partition("## What CMakeLists.txt passes\n")[2].partition("\n## ")[0]
    for line in section.splitlines():
        if line.startswith("| ") and not line.startswith("| id "):
            yield line.strip("| ").split(" | ")


@needs_cmake
@pytest.mark.parametrize("row", [pytest.param(row, id=row[0]) for row in rows()])
def test_row_of_the_page_of_differences(row: list[str], tmp_path: Path) -> None:
    """The row is true for both."""
    _, passed, rosidl, ifgen, why = row
    assert why
    for name in ("other/msg/A.msg", "msg/A.msg", "msg/README.md", "A.msg"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    call = f"rosidl_generate_interfaces(${{PROJECT_NAME}} {passed.strip('`')})"
    (tmp_path / "CMakeLists.txt").write_text(f"project(demo_msgs)\n{call}\n")
    listed = listed_in(tmp_path)
    told = [f"{d.severity}[{d.rule}]" for d in listed.diagnostics if d.rule != "unlisted-interface"]
    assert told == re.findall(r"`((?:error|warning)\[.*?\])`", ifgen)
    assert [path.name for path in listed.paths] == ([] if told == ["error[missing-file]"] else ["A.msg"])
    assert (run_by_cmake(tmp_path).returncode != 0) == (rosidl == "refuses")
    if rosidl == "fails in rosidl_adapter":
        from rosidl_adapter import convert_to_idl

        with pytest.raises(AssertionError):
            convert_to_idl(tmp_path, "demo_msgs", Path("msg/README.md"), tmp_path / "out")
