"""`ifgen generate --keep-going` and `exclude`: what is right is generated, and names only what is there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from ifgen.pipeline import stages

from tests.cli.conftest import Run

NODE = (
    "nodl_version: 2\npublishers:\n"
    "  - {name: /place, type: %s, qos: {history: KEEP_LAST, depth: 5, reliability: RELIABLE}}\n"
)


def write(files: dict[str, str], root: Path) -> None:
    for name, text in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    files = {
        "ws/a_msgs/msg/Bad.msg": "absent_msgs/Foo foo\n",
        "ws/a_msgs/msg/Good.msg": "float64 x\n",
        "ws/b_msgs/msg/User.msg": "a_msgs/Bad[] bad\n",
        "ws/b_msgs/srv/Fine.srv": "a_msgs/Good good\n---\n",
        "ws/c_msgs/action/Top.action": "b_msgs/User user\n---\n---\n",
        "ws/robot/nodl/lost.nodl.yaml": NODE % "b_msgs/msg/User",
        "ws/robot/nodl/well.nodl.yaml": NODE % "a_msgs/msg/Good",
    }
    write(files, tmp_path)
    return tmp_path


def test_what_is_right_is_generated(workspace: Path, ifgen: Run) -> None:
    assert ifgen("generate", "ws", "-o", "out").code == 1
    assert not Path("out").exists()
    done = ifgen("generate", "ws", "-o", "out", "--keep-going")
    assert (done.code, done.err.count("error[")) == (1, 1)
    left = sorted(line for line in done.err.splitlines() if line.startswith("left out: "))
    assert left == [
        "left out: a_msgs/msg/Bad: there is no interface package 'absent_msgs'",
        "left out: b_msgs/msg/User: needs a_msgs/msg/Bad, which is left out",
        "left out: c_msgs/action/Top: needs b_msgs/msg/User, which is left out",
        "left out: robot/nodl/lost: needs b_msgs/msg/User, which is left out",
    ]
    assert {path.name for path in Path("out").iterdir()} == {"a_msgs", "b_msgs", "robot"}
    assert "Bad" not in Path("out/a_msgs/msg/__init__.py").read_text()
    checked = ifgen("generate", "ws", "-o", "out", "--keep-going", "--check")
    assert (checked.code, "up to date" in checked.out) == (1, True), "the mistake is still one"
    write({"ws/a_msgs/msg/Bad.msg": "int32 x\n"}, workspace)
    assert ifgen("generate", "ws", "-o", "out", "--keep-going").code == 0
    assert Path("out/c_msgs").is_dir()
    write({"ws/a_msgs/msg/Bad.msg": "absent_msgs/Foo foo\n"}, workspace)
    assert ifgen("generate", "ws", "-o", "out", "--keep-going").code == 1
    assert not Path("out/c_msgs").exists(), "what needs it goes"
    assert ifgen("generate", "ws", "-o", "out", "--keep-going", "--locked").code == 2


@pytest.mark.parametrize("bad", ["int33 x", "absent_msgs/Foo x", "std_msgs/Nope x"])
def test_a_package_that_loses_everything_does_not_come_back(
    bad: str, tmp_path: Path, ifgen: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Who needs it is left out, too: it is found nowhere, although its files are there."""
    monkeypatch.chdir(tmp_path)
    files = {"a_msgs/msg/A.msg": bad, "b_msgs/msg/B.msg": "a_msgs/A a", "c_msgs/msg/C.msg": "int32 x"}
    write({name: f"{text}\n" for name, text in files.items()}, tmp_path / "ws")
    done = ifgen("generate", "ws", "-o", "out", "--keep-going")
    left = [line.split(":")[1].strip() for line in done.err.splitlines() if line.startswith("left out: ")]
    assert (done.code, sorted(left)) == (1, ["a_msgs/msg/A", "b_msgs/msg/B"])
    assert {path.name for path in Path("out").iterdir()} == {"c_msgs"}


def test_nothing_right_is_a_failure(workspace: Path, ifgen: Run) -> None:
    done = ifgen("generate", "ws/a_msgs/msg/Bad.msg", "-o", "out", "--keep-going")
    assert (done.code, "absent_msgs" in done.err, Path("out").exists()) == (1, True, False)


def test_exclude(workspace: Path, ifgen: Run) -> None:
    done = ifgen("generate", "ws", "-o", "out", "--exclude", "a_msgs/msg/B*")
    assert (done.code, "error" in done.err) == (0, False)
    assert "left out: c_msgs/action/Top: needs b_msgs/msg/User, which is left out" in done.err
    assert {path.name for path in Path("out").iterdir()} == {"a_msgs", "b_msgs", "robot"}
    done = ifgen("generate", "ws", "-o", "out", "--exclude", "a_mgs")
    assert (done.code, "did you mean `a_msgs`" in done.err) == (2, True)
    write({"pyproject.toml": '[tool.ifgen]\npaths = ["ws"]\nexclude = ["a_msgs", "robot"]\n'}, workspace)
    assert ifgen("check").code == 0
    done = ifgen("generate")
    assert (done.code, "there is no interface package 'a_msgs'" in done.err) == (1, True), "nothing is left"


def test_a_file_that_cannot_be_read_is_left_out(workspace: Path, ifgen: Run) -> None:
    Path("ws/b_msgs/msg/Latin.msg").write_bytes(b"# \xe9\nint8 x\n")
    done = ifgen("generate", "ws", "-o", "out", "--keep-going")
    assert (done.code, "left out: b_msgs/msg/Latin: " in done.err) == (1, True)
    assert Path("out/b_msgs/srv").is_dir()


@settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    needs=st.lists(st.lists(st.integers(0, 8), max_size=2), min_size=2, max_size=8),
    wrong=st.sets(st.integers(0, 7), min_size=1, max_size=3),
    data=st.data(),
)
def test_the_output_is_closed(
    needs: list[list[int]], wrong: set[int], data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """A message is generated if neither it nor anything that it holds is wrong, and the package lists it then."""
    root = tmp_path_factory.mktemp("ws")
    mistakes = ("absent_msgs/Foo foo", "int8 X", "std_msgs/Strin text", "int8 x\nint8 x")
    holds = {i: {n for n in needs[i] if n < i} for i in range(len(needs))}
    broken = {i for i in wrong if i < len(needs)}
    for i, held in holds.items():
        fields = "".join(f"p{n % 3}_msgs/M{n} f{n}\n" for n in held)
        mistake = data.draw(st.sampled_from(mistakes)) if i in broken else "int32 n"
        write({f"in/p{i % 3}_msgs/msg/M{i}.msg": f"{mistake}\n{fields}"}, root)
    reached = set(broken)
    for i, held in holds.items():
        if held & reached:
            reached.add(i)
    if len(reached) == len(needs):
        return
    done = stages.generate(root / "in", output=root / "out", keep_going=True)
    assert {left.name for left in done.left_out} == {f"p{i % 3}_msgs/msg/M{i}" for i in reached}
    listed: set[str] = set()
    for index in (root / "out").glob("*/msg/__init__.py"):
        names = re.findall(r'"(M\d+)": "', index.read_text())
        listed |= {f"{index.parent.parent.name}/{name}" for name in names}
    assert listed == {f"p{i % 3}_msgs/M{i}" for i in holds.keys() - reached}
