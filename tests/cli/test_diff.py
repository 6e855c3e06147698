"""`ifgen diff`: two versions of a type side by side, whatever names them, and whatever the terminal's width."""

from __future__ import annotations

from pathlib import Path

import pytest

from .conftest import Git, Outcome, Run, write


@pytest.fixture
def edited(git: Git) -> None:
    """Another version of State than the one in HEAD."""
    write(Path("demo_msgs/msg/State.msg"), "# Edited.\nfloat64 x\nfloat32 y  # [m]\nbool z\n")
    write(Path("pyproject.toml"), '[tool.ifgen]\npaths = ["demo_msgs"]\n')


@pytest.mark.usefixtures("edited")
def test_a_revision_beside_the_type_as_it_is_now(ifgen: Run) -> None:
    done = ifgen("diff", "HEAD:demo_msgs/msg/State")
    assert done == Outcome(
        1,
        "HEAD:demo_msgs/msg/State               | demo_msgs/msg/State\n"
        "demo_msgs/msg/State                      demo_msgs/msg/State\n"
        "RIHS01_a05668a3d6ba4f05...             | RIHS01_27de94e5a16098ac...\n"
        "float64 x                                float64 x\n"
        "float64 y                              | float32 y\n"
        "                                       > bool z\n"
        "\n"
        "field-type: demo_msgs/State.y was `float64`, and is `float32` (breaks source,\n"
        "  hash, wire)\n"
        "field-added: demo_msgs/State.z is new (breaks hash, wire)\n",
        "",
    )


@pytest.mark.usefixtures("edited")
def test_a_narrow_terminal_has_one_version_below_the_other(
    ifgen: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "50")
    done = ifgen("diff", "HEAD:demo_msgs/msg/State")
    assert "- float64 y\n+ float32 y\n+ bool z\n\n" in done.out
    assert all(len(line) <= 50 for line in done.out.splitlines())


@pytest.mark.usefixtures("edited")
def test_all_forms_of_a_version(ifgen: Run) -> None:
    write(Path("earlier/demo_msgs/msg/State.msg"), "float64 x\nfloat64 y\n")
    write(Path("earlier/demo_msgs/msg/Gone.msg"), "int8 x\n")
    earlier = ("HEAD:demo_msgs.msg.State", "earlier:demo_msgs/State", "earlier/demo_msgs/msg/State.msg")
    for one in earlier:
        for other in earlier:
            done = ifgen("diff", one, other)
            assert done == Outcome(0, f"{one} and {other} do not differ\n", "")
        assert "field-type: " in ifgen("diff", one, "demo_msgs/msg/State").out
    assert ifgen("lock").code == 0
    assert "field-type: " in ifgen("diff", "HEAD:demo_msgs/msg/State", "ifgen.lock:demo_msgs::msg::State").out
    assert ifgen("diff", "ifgen.lock:demo_msgs/State").code == 0
    whole = ifgen("diff", "earlier", "ifgen.lock").out
    assert whole.startswith("earlier                                | ifgen.lock\ndemo_msgs/msg/Gone ")
    assert "| (no such type)" in whole
    assert whole.count("\nearlier ") == 1
    assert "field-type: " in ifgen("diff", "HEAD:demo_msgs", "demo_msgs").out


def test_nested_types_services_and_wide_characters(ifgen: Run) -> None:
    write(Path("a/demo_msgs/msg/Part.msg"), "int8 x\n")
    write(Path("b/demo_msgs/msg/Part.msg"), "int16 x\n")
    for folder in ("a", "b"):
        write(Path(folder) / "demo_msgs/srv/Go.srv", "Part[] parts\n---\nPart part\nstring K='ü界\x1b界'\n")
    done = ifgen("diff", "a:demo_msgs/srv/Go", "b:demo_msgs/srv/Go")
    assert done.code == 1
    assert "    int8 x                             |     int16 x\n---      " in done.out
    assert '"ü界\N{REPLACEMENT CHARACTER}界"                        string K="ü界' in done.out
    assert "field-type: demo_msgs/srv/Go_Request.parts.x was `int8`, and is `int16`" in done.out
    assert done.out.count("field-type") == 1


@pytest.mark.usefixtures("edited")
@pytest.mark.parametrize(
    ("words", "rule"),
    [
        (("demo_msgs/msg/State",), "unknown-type"),
        (("HEAD:demo_msgs/msg/Nothing",), "unknown-type"),
        (("nowhere:demo_msgs/msg/State",), "unknown-revision"),
        (("ifgen.lock:State", "State"), "unknown-revision"),
        (("HEAD:", "demo_msgs/State"), "unknown-package"),
        (("", "demo_msgs/State"), "unknown-package"),
        (("README.md", "State"), "no-interfaces"),
        (("demo_msgs/msg/Wrong.msg", "demo_msgs/msg/State"), "missing-name"),
    ],
)
def test_what_is_not_there_is_one_error(ifgen: Run, words: tuple[str, ...], rule: str) -> None:
    write(Path("README.md"), "")
    write(Path("demo_msgs/msg/Wrong.msg"), "int8\n")
    done = ifgen("diff", *words)
    assert done.code in {1, 2}
    assert done.out == ""
    assert done.err.startswith(f"error[{rule}]: ")
    assert done.err.count("error[") == 1


def test_a_revision_alone_is_said_to_be_one(ifgen: Run, git: Git) -> None:
    done = ifgen("diff", "std_msgs/msg/String", "HEAD")
    assert (done.code, "write the type after it: `HEAD:" in done.err) == (2, True), done
