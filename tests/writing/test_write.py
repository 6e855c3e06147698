"""Guarantees for users: their files are not touched, and a run's files appear completely or not at all."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
import threading
from collections.abc import Mapping
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from ifgen.diagnostics import InputError
from ifgen.reading import manifest
from ifgen.writing import transaction, write
from ifgen.writing.write import OutputPackage

GENERATOR = "ifgen test"


def package(files: Mapping[str, str], name: str = "demo_msgs") -> OutputPackage:
    return OutputPackage(name, files)


def generate(out: Path, files: Mapping[str, str], name: str = "demo_msgs") -> write.Written:
    out.mkdir(exist_ok=True)
    return write.write([package(files, name)], out, GENERATOR)


def tree(folder: Path) -> dict[str, str]:
    return {p.relative_to(folder).as_posix(): p.read_text() for p in sorted(folder.rglob("*")) if p.is_file()}


def generated(out: Path) -> dict[str, str]:
    found = tree(out / "demo_msgs")
    del found[manifest.NAME]
    return found


def is_intact(package: str, out: Path) -> bool:
    record = manifest.read(out / package)
    return record is not None and write.is_intact(record, out / package, out)


@pytest.fixture
def out(tmp_path: Path) -> Path:
    return tmp_path / "out"


def test_first_run_writes_files_and_manifest(out: Path) -> None:
    done = generate(out, {"msg/__init__.py": "x = 1\n", "py.typed": ""})
    assert {p.name for p in done.written} == {"__init__.py", "py.typed"}
    record = manifest.read(out / "demo_msgs")
    assert record is not None
    assert set(record.files) == {"msg/__init__.py", "py.typed"}
    assert is_intact("demo_msgs", out)
    assert sorted(p.name for p in out.iterdir()) == ["demo_msgs"], "the stage is gone"


def test_unchanged_files_keep_their_time_stamp_and_stale_ones_go(out: Path) -> None:
    generate(out, {"msg/a.py": "a", "msg/b.py": "b", "srv/c.py": "c"})
    for path in out.rglob("*.py"):
        os.utime(path, ns=(1, 1))
    (out / "demo_msgs/srv/__pycache__").mkdir()
    (out / "demo_msgs/srv/__pycache__/c.cpython-311.pyc").touch()
    done = generate(out, {"msg/a.py": "a", "msg/b.py": "B"})
    assert (out / "demo_msgs/msg/a.py").stat().st_mtime_ns == 1
    assert (out / "demo_msgs/msg/b.py").read_text() == "B"
    assert done.removed == (out / "demo_msgs/srv/c.py",)
    assert not (out / "demo_msgs/srv").exists(), "a folder without files would be a namespace package"
    before = (out / "demo_msgs" / manifest.NAME).stat().st_mtime_ns
    assert generate(out, {"msg/a.py": "a", "msg/b.py": "B"}).written == ()
    assert (out / "demo_msgs" / manifest.NAME).stat().st_mtime_ns == before


@pytest.mark.parametrize("prefix", [None, "bytecode"])
def test_python_takes_the_last_of_two_versions_within_a_second(
    out: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, prefix: str | None
) -> None:
    module = out / "demo_msgs" / "_pose.py"
    kept = prefix and str(tmp_path / prefix)
    monkeypatch.setattr(sys, "pycache_prefix", kept)
    environment = {**os.environ, "PYTHONPATH": str(out), "PYTHONPYCACHEPREFIX": kept or ""}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    for number in ("1", "2"):
        generate(out, {"_pose.py": f"print({number})\n"})
        os.utime(module, (10**9, 10**9))
        command = [sys.executable, "-c", "import demo_msgs._pose"]
        assert subprocess.check_output(command, env=environment, text=True, timeout=60) == f"{number}\n"
    assert list((tmp_path / prefix if prefix else module.parent).rglob("_pose.*.pyc"))


def test_files_of_others_stay(out: Path) -> None:
    generate(out, {"msg/a.py": "a", "msg/b.py": "b"})
    (out / "demo_msgs/msg/mine.py").write_text("mine")
    (out / "README").write_text("mine")
    (out / "demo_msgs/msg/b.py").write_text("b, edited")
    done = generate(out, {"msg/a.py": "a"})
    assert done.removed == ()
    assert done.kept == (out / "demo_msgs/msg/b.py",)
    found = tree(out)
    assert found.pop("demo_msgs/" + manifest.NAME)
    assert found == {
        "README": "mine",
        "demo_msgs/msg/a.py": "a",
        "demo_msgs/msg/b.py": "b, edited",
        "demo_msgs/msg/mine.py": "mine",
    }


def test_what_was_edited_is_kept_when_it_is_generated_again(out: Path) -> None:
    generate(out, {"a.py": "a", "sub/b.py": "b\n", "c.py": "c\n", "d.py": "d"})
    (out / "demo_msgs/a.py").write_text("edited")
    (out / "demo_msgs/sub/b.py").write_bytes(b"b\r\n")  # as git checks out on Windows
    (out / "demo_msgs/d.py").write_text("new d")  # as if a merge had brought it
    done = generate(out, {"a.py": "new a", "sub/b.py": "new b\n", "c.py": "new c\n", "d.py": "new d"})
    assert done.edited == (out / "demo_msgs/a.py",)
    assert set(done.written) == {out / "demo_msgs" / name for name in ("a.py", "c.py", "sub/b.py")}
    assert generated(out) == {"a.py": "new a", "c.py": "new c\n", "d.py": "new d", "sub/b.py": "new b\n"}
    assert tree(out / write.EDITED) == {".gitignore": "*\n", "demo_msgs/a.py": "edited"}
    again = generate(out, {"a.py": "a"})
    assert again.edited == ()
    (out / "demo_msgs/a.py").write_text("edited again")
    assert generate(out, {"a.py": "a"}).edited == (out / "demo_msgs/a.py",)
    assert tree(out / write.EDITED) == {".gitignore": "*\n", "demo_msgs/a.py": "edited again"}


def test_a_foreign_file_in_the_way_is_refused_and_nothing_is_written(out: Path) -> None:
    (out / "demo_msgs/msg").mkdir(parents=True)
    (out / "demo_msgs/msg/b.py").write_text("by hand")
    with pytest.raises(InputError, match="ifgen did not write it"):
        generate(out, {"msg/a.py": "a", "msg/b.py": "b"})
    assert tree(out) == {"demo_msgs/msg/b.py": "by hand"}


def test_a_lost_manifest_is_no_reason_to_refuse_what_is_equal(out: Path) -> None:
    generate(out, {"a.py": "a"})
    (out / "demo_msgs" / manifest.NAME).unlink()
    assert generate(out, {"a.py": "a"}).written == ()
    assert is_intact("demo_msgs", out)


@pytest.mark.parametrize(
    "text", ["", "{", "[]", '{"format": 99}', '{"format": 1, "files": []}', "<<<<<<< HEAD"]
)
def test_a_broken_manifest_is_an_error_with_advice(out: Path, text: str) -> None:
    generate(out, {"a.py": "a"})
    (out / "demo_msgs" / manifest.NAME).write_text(text)
    with pytest.raises(InputError) as caught:
        generate(out, {"a.py": "b"})
    [found] = caught.value.diagnostics
    assert found.rule == "broken-manifest"
    assert found.help
    assert (out / "demo_msgs/a.py").read_text() == "a"


def test_a_manifest_cannot_make_us_remove_a_file_elsewhere(out: Path, tmp_path: Path) -> None:
    generate(out, {"a.py": "a"})
    victim = tmp_path / "victim"
    victim.write_text("v")
    record = manifest.Manifest("", None, (), {"../../victim": manifest.digest(b"v")})
    (out / "demo_msgs" / manifest.NAME).write_text(record.to_text())
    with pytest.raises(InputError, match="outside the package"):
        generate(out, {"a.py": "b"})
    assert victim.exists()


def test_links_and_names_that_lead_out_are_refused(out: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    out.mkdir()
    (out / "demo_msgs").symlink_to(elsewhere)
    with pytest.raises(InputError, match="outside the output folder"):
        generate(out, {"a.py": "a"})
    with pytest.raises(InputError, match="outside the output folder"):
        generate(out, {"../../a.py": "a"}, "other")
    assert tree(elsewhere) == {}


def test_the_output_folder_itself_may_be_a_link(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    (tmp_path / "out").symlink_to("real")
    generate(tmp_path / "out", {"a.py": "a"})
    assert (tmp_path / "real/demo_msgs/a.py").read_text() == "a"


def fail_once(patched: pytest.MonkeyPatch, method: str, calls: int, error: BaseException) -> None:
    """Let the given number of calls of a method of Path through, and fail the next one."""
    original = getattr(Path, method)

    def limited(*args: object, **kwargs: object) -> object:
        nonlocal calls
        calls -= 1
        if calls == -1:
            raise error
        return original(*args, **kwargs)

    patched.setattr(Path, method, limited)


FULL = OSError(errno.ENOSPC, "No space left on device")


@pytest.mark.parametrize("error", [FULL, KeyboardInterrupt()], ids=["disk full", "Ctrl-C"])
@pytest.mark.parametrize("method", ["write_bytes", "replace", "mkdir", "unlink"])
def test_every_file_is_as_before_whenever_a_run_fails(
    out: Path, monkeypatch: pytest.MonkeyPatch, method: str, error: BaseException
) -> None:
    """Fail at the first, the second, the third ... call, until the run succeeds."""
    first = {"msg/a.py": "a", "msg/b.py": "b", "stale.py": "s"}
    second = {"msg/a.py": "A", "msg/b.py": "b", "srv/new/c.py": "c", "action/d.py": "d"}
    generate(out, first)
    before = tree(out)
    os.utime(out / "demo_msgs/msg/a.py", ns=(1, 1))
    for calls in range(100):
        with monkeypatch.context() as patched:
            fail_once(patched, method, calls, error)
            try:
                generate(out, second)
            except type(error):
                failed = True
            else:
                failed = False
        if not failed:
            break
        assert tree(out) == before
        assert (out / "demo_msgs/msg/a.py").stat().st_mtime_ns == 1
        assert not (out / "demo_msgs/srv").exists()
    assert calls > 0
    assert generated(out) == second


def test_a_run_that_was_killed_leaves_nothing_that_stops_the_next(
    out: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The run is killed after each step in turn: the next run starts with what is on the disk then."""
    first = {"msg/a.py": "a", "stale.py": "s"}
    second = {"msg/a.py": "A", "msg/new.py": "n", "srv/c.py": "c"}

    class Killed(BaseException):
        pass

    for steps in range(20):
        folder = out.with_name(f"out{steps}")
        generate(folder, first)
        with monkeypatch.context() as patched:
            patched.setattr(transaction, "_undone_on_failure", _never_undone)
            patched.setattr(transaction.shutil, "rmtree", lambda *_, **__: None)
            fail_once(patched, "replace", steps, Killed())
            try:
                generate(folder, second)
            except Killed:
                killed = True
            else:
                killed = False
        assert generate(folder, second).edited == (), "what is still the old one was not edited"
        assert generated(folder) == second
        if not killed:
            return
    pytest.fail("never got through")


class _never_undone(list[object]):
    def __enter__(self) -> _never_undone:
        return self

    def __exit__(self, *_: object) -> None:
        pass


def test_runs_take_turns(out: Path) -> None:
    order: list[str] = []
    inside = threading.Event()

    def second() -> None:
        inside.wait()
        with transaction.locked(out):
            order.append("second")

    thread = threading.Thread(target=second)
    thread.start()
    with transaction.locked(out):
        inside.set()
        thread.join(0.1)
        order.append("first")
    thread.join()
    assert order == ["first", "second"]
    assert not out.exists(), "a folder made for nothing goes again"


def test_drift_says_what_writing_would_do(out: Path) -> None:
    assert [(d.path.name, d.found, d.expected) for d in write.drift([package({"a.py": "a"})], out)] == [
        ("a.py", None, "a")
    ]
    assert not out.exists()
    generate(out, {"a.py": "a", "b.py": "b", "c.py": "c"})
    assert write.drift([package({"a.py": "a", "b.py": "b", "c.py": "c"})], out) == ()
    (out / "demo_msgs/a.py").write_text("edited")
    (out / "demo_msgs/b.py").unlink()
    found = write.drift([package({"a.py": "a", "b.py": "b"})], out)
    assert [(d.path.name, d.found, d.expected) for d in found] == [
        ("a.py", "edited", "a"),
        ("b.py", None, "b"),
        ("c.py", "c", None),
    ]


def test_a_package_without_files_is_removed(out: Path) -> None:
    generate(out, {"a.py": "a", "msg/b.py": "b"})
    assert len(generate(out, {}).removed) == 2
    assert list(out.iterdir()) == []


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=8,
)


@given(
    JSON
    | st.fixed_dictionaries(
        {"format": st.just(1), "generator": st.text(), "source": JSON, "interfaces": JSON, "files": JSON}
    )
)
def test_any_manifest_is_read_or_refused(tmp_path_factory: pytest.TempPathFactory, document: object) -> None:
    folder = tmp_path_factory.mktemp("m")
    (folder / manifest.NAME).write_text(json.dumps(document))
    try:
        found = manifest.read(folder)
    except ValueError:
        return
    assert found is not None
    assert all(
        (folder / name).resolve().is_relative_to(folder.resolve()) for name in found.files if "\0" not in name
    )


def test_what_is_the_users_is_written_once(out: Path) -> None:
    out.mkdir()
    package = OutputPackage("demo", {"base.py": "base"}, once={"node.py": "first"})
    node = out / "demo/node.py"
    assert node in write.write([package], out, GENERATOR).written
    node.write_text("mine")
    again = OutputPackage("demo", {"base.py": "base"}, once={"node.py": "second"})
    assert write.write([again], out, GENERATOR) == write.Written(unchanged=(out / "demo/base.py",))
    assert node.read_text() == "mine"
    assert write.drift([again], out) == ()
    assert is_intact("demo", out)
    node.unlink()
    assert not is_intact("demo", out)
    assert [d.expected for d in write.drift([again], out)] == ["second"]


@pytest.mark.parametrize("gone", [OutputPackage("demo", {"base.py": "base"}), OutputPackage("demo", {})])
def test_what_is_the_users_stays_when_nothing_needs_it(gone: OutputPackage, out: Path) -> None:
    out.mkdir()
    node = out / "demo/node.py"
    write.write([OutputPackage("demo", {"base.py": "base"}, once={"node.py": "first"})], out, GENERATOR)
    assert write.left_behind(gone, out) == [node]
    write.write([gone], out, GENERATOR)
    assert node.read_text() == "first"
    assert write.left_behind(gone, out) == [], "told once"


def test_a_generated_file_that_becomes_the_users_stays_as_it_is(out: Path) -> None:
    generate(out, {"node.py": "ours"})
    write.write([OutputPackage("demo_msgs", {"base.py": "base"}, once={"node.py": "new"})], out, GENERATOR)
    assert (out / "demo_msgs/node.py").read_text() == "ours"
