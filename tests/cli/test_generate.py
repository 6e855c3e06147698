"""`ifgen generate` from its user's point of view."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest

from .conftest import Run, write


def tree(folder: Path) -> set[str]:
    return {p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file() and p.suffix != ".pyc"}


DEMO = {
    "demo_msgs/.ifgen-manifest.json",
    "demo_msgs/__init__.py",
    "demo_msgs/py.typed",
    "demo_msgs/msg/__init__.py",
    "demo_msgs/msg/_pair.py",
    "demo_msgs/msg/_pose.py",
    "demo_msgs/srv/__init__.py",
    "demo_msgs/srv/_move.py",
    "demo_msgs/test/test_demo_msgs_interfaces.py",
}


def test_a_package(ifgen: Run, demo_msgs: Path) -> None:
    done = ifgen("generate", "demo_msgs")
    assert (done.code, done.out, done.err) == (0, "generated: 8 files written\n", "")
    assert tree(Path("generated")) == DEMO, "dependencies are not written: they would shadow a real ROS"
    done = ifgen("generate", "demo_msgs")
    assert (done.code, done.out) == (0, "generated: up to date (8 files)\n")


def test_without_tests(ifgen: Run, demo_msgs: Path, tmp_path: Path) -> None:
    assert ifgen("generate", "demo_msgs", "--no-tests").out == "generated: 7 files written\n"
    assert not Path("generated/demo_msgs/test").exists()
    assert ifgen("generate", "demo_msgs").out == "generated: 1 file written, 7 files unchanged\n"
    write(tmp_path / "pyproject.toml", '[tool.ifgen]\npaths = ["demo_msgs"]\ntests = false\n')
    assert "removed generated/demo_msgs/test/test_demo_msgs_interfaces.py\n" in ifgen("generate").out
    assert not Path("generated/demo_msgs/test").exists()
    assert ifgen("generate", "--check").code == 0
    assert ifgen("generate", "--check", "--tests").code == 1


def test_with_dependencies(ifgen: Run, demo_msgs: Path) -> None:
    assert ifgen("generate", "demo_msgs", "--with-deps", "-o", "out").code == 0
    packages = {p.name for p in Path("out").iterdir()}
    assert packages == {"demo_msgs", "std_msgs", "builtin_interfaces", "service_msgs"}
    assert Path("out/std_msgs/msg/_string.py").exists(), "dependencies come whole"
    code = "import sys; from demo_msgs.msg import Pose; p = Pose(x=2.0); print(p.x, p.header.frame_id == '')"
    environment = {**os.environ, "PYTHONPATH": f"out{os.pathsep}{os.pathsep.join(sys.path)}"}
    found = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True, timeout=60
    )
    assert found.stdout == "2.0 True\n"


def test_with_own_dependencies(ifgen: Run, demo_msgs: Path, tmp_path: Path) -> None:
    """The word after `--with-deps` is a PATH, whatever its name."""
    write(tmp_path / "libs/own_msgs/msg/A.msg", "int8 a\n")
    write(tmp_path / "own/msg/B.msg", "own_msgs/A a\nstd_msgs/String b\n")
    done = ifgen("generate", "-I", "libs", "own")
    assert done.code == 0
    assert "warning[not-generated]: nothing provides package 'own_msgs' at run time" in done.err
    assert ifgen("generate", "-I", "libs", "--with-deps", "own").err == ""
    assert {p.name for p in Path("generated").iterdir()} == {
        "own",
        "own_msgs",
        "std_msgs",
        "builtin_interfaces",
    }
    assert "removed generated/std_msgs\n" in ifgen("generate", "-I", "libs", "--with-deps=own", "own").out
    assert {p.name for p in Path("generated").iterdir()} == {"own", "own_msgs"}
    write(
        tmp_path / "pyproject.toml",
        '[tool.ifgen]\npaths = ["own"]\ninclude = ["libs"]\nwith_deps = "own"\n',
    )
    assert ifgen("generate", "--check").code == 0
    assert ifgen("generate", "--check", "--no-with-deps").code == 1
    assert ifgen("generate", "--with-deps=some").code == 2


def test_the_output_is_not_among_the_sources(ifgen: Run, tmp_path: Path) -> None:
    write(tmp_path / "interfaces/demo_msgs/msg/A.msg", "int8 a\n")
    done = ifgen("generate", "interfaces", "-o", "interfaces")
    assert done.code == 2
    assert "would be generated into its own source, interfaces/demo_msgs" in done.err.replace("\n", " ")


def test_configuration(ifgen: Run, demo_msgs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path / "pyproject.toml", '[tool.ifgen]\npaths = ["demo_msgs"]\noutput = "from config"\n')
    (tmp_path / "deep/er").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "deep/er")
    assert ifgen("generate").out == f"{tmp_path}/from config: 8 files written\n"
    assert tree(tmp_path / "from config") == DEMO
    write(tmp_path / "pyproject.toml", '[tool.ifgen]\npath = ["demo_msgs"]\n')
    done = ifgen("generate")
    assert done.code == 2
    assert "[tool.ifgen] has no key 'path'" in done.err
    assert "did you mean 'paths'?" in done.err


def test_stale_files_and_packages_go(ifgen: Run, demo_msgs: Path, tmp_path: Path) -> None:
    write(tmp_path / "ws/a_msgs/msg/A.msg", "int32 a\n")
    write(tmp_path / "ws/b_msgs/msg/B.msg", "int32 b\n")
    write(tmp_path / "ws/b_msgs/srv/C.srv", "---\n")
    ifgen("generate", "ws")
    ifgen("generate", "demo_msgs")
    (tmp_path / "ws/b_msgs/srv/C.srv").unlink()
    (tmp_path / "ws/a_msgs").rename(tmp_path / "ws/new_msgs")
    done = ifgen("generate", "ws", "--check")
    assert done.code == 1
    assert "--- generated/a_msgs/msg/_a.py (stale)" in done.out
    assert "+++ generated/new_msgs/msg/_a.py (missing)" in done.out
    done = ifgen("generate", "ws")
    assert "removed generated/b_msgs/srv/_c.py\n" in done.out
    found = tree(Path("generated"))
    assert {name.split("/")[0] for name in found} == {"b_msgs", "new_msgs", "demo_msgs"}
    assert not Path("generated/b_msgs/srv").exists()
    assert ifgen("generate", "ws", "--check").code == 0


def test_a_package_that_is_renamed(ifgen: Run, demo_msgs: Path) -> None:
    ifgen("generate", "demo_msgs")
    write(demo_msgs / "package.xml", "<package><name>better_msgs</name></package>")
    assert "removed generated/demo_msgs\n" in ifgen("generate", "demo_msgs").out
    assert {p.name for p in Path("generated").iterdir()} == {"better_msgs"}


def test_a_single_file_adds_to_its_package(ifgen: Run, demo_msgs: Path) -> None:
    ifgen("generate", "demo_msgs/srv/Move.srv")
    assert Path("generated/demo_msgs/msg/_pose.py").exists(), "what it needs of its own package comes along"
    assert not Path("generated/demo_msgs/msg/_pair.py").exists()
    ifgen("generate", "demo_msgs/msg/Pair.msg")
    assert tree(Path("generated")) == DEMO
    assert "Pair" in Path("generated/demo_msgs/msg/__init__.py").read_text()
    assert "Move" in Path("generated/demo_msgs/srv/__init__.py").read_text()
    (demo_msgs / "srv/Move.srv").unlink()
    ifgen("generate", "demo_msgs/msg/Pair.msg")
    assert not Path("generated/demo_msgs/srv").exists()


def test_check_tells_the_truth_whatever_was_edited(ifgen: Run, demo_msgs: Path) -> None:
    ifgen("generate", "demo_msgs")
    assert ifgen("generate", "demo_msgs", "--check").out == "generated: up to date\n"
    pose = Path("generated/demo_msgs/msg/_pose.py")
    before = pose.read_text()
    pose.write_text(before.replace("class Pose(", "class Posture("))
    done = ifgen("generate", "demo_msgs", "--check")
    assert done.code == 1
    assert done.out.startswith(
        "--- generated/demo_msgs/msg/_pose.py\n+++ generated/demo_msgs/msg/_pose.py (as generated)\n@@ "
    )
    assert "\n-class Posture(" in done.out
    assert "\n+class Pose(" in done.out
    assert done.err == "1 file is not up to date: run `ifgen generate`\n"
    assert "Posture" in pose.read_text(), "a check writes nothing"
    assert ifgen("generate", "demo_msgs").out == "generated: 1 file written, 7 files unchanged\n"
    assert pose.read_text() == before
    pose.unlink()
    assert "(missing)" in ifgen("generate", "demo_msgs", "--check").out
    assert not pose.exists()


def test_a_check_does_not_flood_the_terminal(ifgen: Run, tmp_path: Path) -> None:
    for index in range(20):
        write(tmp_path / f"demo_msgs/msg/A{index}.msg", "int32 a\n")
    ifgen("generate", "demo_msgs")
    for index in range(20):
        write(tmp_path / f"demo_msgs/msg/A{index}.msg", "".join(f"int32 b{i}\n" for i in range(20)))
    done = ifgen("generate", "demo_msgs", "--check")
    assert len(done.out.splitlines()) < 430
    assert "\n... (the rest is left out)\n*** generated/demo_msgs/msg/_a" in done.out
    assert done.err.startswith("21 files are not up to date")


def test_an_interface_that_changes(ifgen: Run, demo_msgs: Path) -> None:
    ifgen("generate", "demo_msgs")
    write(demo_msgs / "msg/Pose.msg", "int32 n\n")
    assert ifgen("generate", "demo_msgs", "--check").code == 1
    # Pair and Move hold a Pose, so their type hashes change too, and so do the tests.
    assert ifgen("generate", "demo_msgs").out == "generated: 4 files written, 4 files unchanged\n"


def test_a_dependency_that_changes(ifgen: Run, tmp_path: Path) -> None:
    write(tmp_path / "deps/base_msgs/msg/Base.msg", "int32 n\n")
    write(tmp_path / "top_msgs/msg/Top.msg", "base_msgs/Base base\n")
    assert ifgen("generate", "top_msgs").code == 1
    assert ifgen("generate", "top_msgs", "-I", "deps").code == 0
    write(tmp_path / "deps/base_msgs/msg/Base.msg", "int64 n\n")
    assert "2 files written" in ifgen("generate", "top_msgs", "-I", "deps").out


def test_mistakes_leave_everything_as_it_was(ifgen: Run, demo_msgs: Path) -> None:
    ifgen("generate", "demo_msgs")
    before = {p: p.stat().st_mtime_ns for p in Path("generated").rglob("*")}
    write(demo_msgs / "msg/New.msg", "int32 n\n")
    write(demo_msgs / "msg/Pose.msg", "float64 x\nfloat64 x\nPoes p\n")
    done = ifgen("generate", "demo_msgs")
    assert done.code == 1
    assert done.out == ""
    assert "demo_msgs/msg/Pose.msg:2:9" in done.err
    assert "demo_msgs/msg/Pose.msg:3:1" in done.err, "all mistakes at once"
    assert "2 errors" in done.err
    assert {p: p.stat().st_mtime_ns for p in Path("generated").rglob("*")} == before


def test_a_mistake_in_the_first_run_leaves_no_folder(ifgen: Run, tmp_path: Path) -> None:
    write(tmp_path / "demo_msgs/msg/Pose.msg", "nonsense\n")
    assert ifgen("generate", "demo_msgs", "-o", "a/b/c").code == 1
    assert not Path("a").exists()


def test_output_that_is_not_ours(ifgen: Run, demo_msgs: Path, tmp_path: Path) -> None:
    write(tmp_path / "generated/demo_msgs/msg/_pose.py", "mine")
    done = ifgen("generate", "demo_msgs")
    assert done.code == 1
    assert done.err == (
        "error[foreign-file]: generated/demo_msgs/msg/_pose.py is in the way: ifgen did not write it\n"
        "  = help: move it away, or choose another folder\n"
    )
    assert tree(tmp_path / "generated") == {"demo_msgs/msg/_pose.py"}


def test_output_that_is_a_file(ifgen: Run, demo_msgs: Path, tmp_path: Path) -> None:
    write(tmp_path / "out", "")
    assert ifgen("generate", "demo_msgs", "-o", "out").code == 2
    assert ifgen("generate", "demo_msgs", "-o", "out").err.startswith(
        "error: invalid value for '-o' / '--output': Directory 'out' is a file\n"
    )
    for more in ((), ("--check",)):
        done = ifgen("generate", "demo_msgs", "-o", "out/below", *more)
        assert done.code == 1
        assert done.err.startswith("error: out/below")
        assert ": Not a directory\n  = help: a part of this path is a file" in done.err


@pytest.mark.parametrize(
    ("failure", "code", "said"),
    [
        (
            OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)),
            1,
            "error: generated: No space left on device\n"
            "  = help: free some space, or choose a folder on another disk\n",
        ),
        (
            PermissionError(errno.EACCES, os.strerror(errno.EACCES), "generated/x"),
            1,
            "error: generated/x: Permission denied\n"
            "  = help: fix its permissions, or choose another folder\n",
        ),
        (KeyboardInterrupt(), 130, "interrupted: no file was changed\n"),
    ],
)
def test_failures_while_writing(
    ifgen: Run, demo_msgs: Path, monkeypatch: pytest.MonkeyPatch, failure: BaseException, code: int, said: str
) -> None:
    def fail(*_: object) -> None:
        raise failure

    monkeypatch.setattr(Path, "write_bytes", fail)
    done = ifgen("generate", "demo_msgs")
    assert (done.code, done.out, done.err) == (code, "", said)
    assert not Path("generated").exists()


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may write everywhere")
def test_output_that_is_read_only(ifgen: Run, demo_msgs: Path, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir(mode=0o500)
    done = ifgen("generate", "demo_msgs", "-o", "out")
    assert done.code == 1
    assert done.err.startswith("error: out: Permission denied\n")


@pytest.mark.parametrize("name", ["with space", "Ünïcödé-机器人", "weird\udcff", "-dash"])
def test_names_of_folders(ifgen: Run, tmp_path: Path, name: str) -> None:
    write(tmp_path / name / "demo_msgs/msg/Pose.msg", "# é 机器人\nfloat64 x\n")
    done = ifgen("generate", f"./{name}", "-o", f"./{name}/out")
    assert (done.code, done.err) == (0, "")
    assert "机器人" in (tmp_path / name / "out/demo_msgs/msg/_pose.py").read_text()
    write(tmp_path / name / "demo_msgs/msg/Pose.msg", "wrong\n")
    assert "demo_msgs/msg/Pose.msg:1:1" in ifgen("generate", f"./{name}").err


def test_links_in_the_input(ifgen: Run, demo_msgs: Path, tmp_path: Path) -> None:
    (tmp_path / "ws").mkdir()
    (tmp_path / "ws/demo_msgs").symlink_to(demo_msgs)
    (tmp_path / "ws/loop").symlink_to(tmp_path / "ws")
    assert ifgen("generate", "ws").code == 0
    assert tree(Path("generated")) == DEMO


def test_wrong_usage(ifgen: Run, demo_msgs: Path) -> None:
    def error(*arguments: str) -> str:
        done = ifgen("generate", *arguments)
        assert (done.code, done.out) == (2, "")
        return done.err.splitlines()[0]

    missing = "Path 'nowhere' does not exist"
    assert error("nowhere") == f"error: invalid value for '[PATH]...': {missing}"
    assert error("demo_msgs", "-o", "out", "nowhere").endswith(missing)
    assert error("demo_msgs", "--chek").startswith("error: no such option '--chek'")
    assert "did you mean '--check'" in ifgen("generate", "demo_msgs", "--chek").err
    assert error("demo_msgs", "-I", "nowhere").endswith("Directory 'nowhere' does not exist")
    assert error("demo_msgs", "-I", "demo_msgs/msg/Pose.msg").endswith("is a file")
    assert error("demo_msgs", "--check", "--watch") == "error: --check cannot be used with --watch"
    assert error().startswith("error[no-path]: there is nothing to work on")


def test_arguments_in_any_order(ifgen: Run, demo_msgs: Path, tmp_path: Path) -> None:
    write(tmp_path / "b_msgs/msg/B.msg", "int32 b\n")
    assert ifgen("generate", "demo_msgs", "-o", "out", "b_msgs").code == 0
    assert {p.name for p in Path("out").iterdir()} == {"demo_msgs", "b_msgs"}


def test_nothing_to_generate(ifgen: Run, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    done = ifgen("generate", "empty")
    assert done.code == 1
    assert done.err.startswith("error[no-interfaces]: no interface files in empty\n")


def test_line_ends_that_git_changed(ifgen: Run, demo_msgs: Path) -> None:
    """Print one line per file instead of a diff without a visible difference, and what to do about it."""
    ifgen("generate", "demo_msgs")
    path = Path("generated/demo_msgs/msg/_pose.py")
    path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
    done = ifgen("generate", "demo_msgs", "--check")
    assert (done.code, done.out) == (1, "*** generated/demo_msgs/msg/_pose.py (line ends differ)\n")
    assert done.err == (
        "1 file is not up to date: run `ifgen generate`\n"
        "  = help: git changes line ends here; put `generated/** text=auto eol=lf` into .gitattributes\n"
    )
