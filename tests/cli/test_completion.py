"""Completion in shells, requested as the scripts request it, and in a real bash."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from .conftest import Run, write


@pytest.fixture
def complete(ifgen: Run, monkeypatch: pytest.MonkeyPatch) -> Run:
    """`complete("show", "std")`: the candidates for the last word, as `type,value`."""

    def ask(*words: str) -> list[str]:
        monkeypatch.setenv("_IFGEN_COMPLETE", "bash_complete")
        monkeypatch.setenv("COMP_WORDS", " ".join(("ifgen", *words)))
        monkeypatch.setenv("COMP_CWORD", str(len(words)))
        done = ifgen()
        assert (done.code, done.err) == (0, "")
        return done.out.split()

    return ask


def test_commands_options_and_files(complete: Run) -> None:
    assert complete("gen") == ["plain,generate", "plain,generators"]
    assert complete("typ") == ["plain,typings"]
    assert complete("paths", "--format", "py") == ["plain,pyright", "plain,pycharm"]
    assert complete("templates", "ex") == ["plain,export"]
    assert complete("generate", "--in") == ["plain,--include"]
    assert complete("check", "--format", "g") == ["plain,github"]
    assert complete("check", "demo") == ["file,demo"]
    assert complete("check", "-I", "demo") == ["dir,demo"]
    assert complete("run", "serv") == ["file,serv"]
    assert complete("run", "server.py", ":", "cli") == ["file,cli"]


def test_packages_and_their_programs(complete: Run) -> None:
    write(Path("src/my_pkg/package.xml"), "<package format='3'><name>my_pkg</name></package>")
    setup = (
        "setup(entry_points={'console_scripts': ['talker = my_pkg.talker:main', 'other=my_pkg.other:run']})"
    )
    write(Path("src/my_pkg/setup.py"), setup)
    assert complete("run", "my_") == ["file,my_", "plain,my_pkg"]
    assert complete("run", "my_pkg", "") == ["plain,other", "plain,talker"]
    assert complete("run", "a.py", ":", "my_pkg", "ta") == ["plain,talker"]
    assert complete("run", "my_pkg", "talker", "x") == ["file,x"]
    assert complete("test", "my_") == ["plain,my_pkg"]


def test_the_users_files_and_packages_come_before_those_of_the_demo(complete: Run) -> None:
    assert "plain,camera_driver" in complete("run", "cam")
    assert "plain,camera_driver" in complete("test", "cam")
    write(Path("camera.py"), "")
    assert complete("run", "cam") == ["file,cam"]
    for name in ("camera_calibration", "teleop"):
        write(Path(f"src/{name}/package.xml"), f"<package format='3'><name>{name}</name></package>")
        write(Path(f"src/{name}/setup.py"), "setup(entry_points={'console_scripts': ['a = b:c']})")
    assert complete("run", "cam") == ["plain,camera.py", "plain,camera_calibration"]
    assert complete("run", "./cam") == ["file,./cam"]
    assert complete("test", "cam") == ["plain,camera_calibration"]
    assert "plain,camera_driver" not in complete("test", "")


def test_names_of_types(complete: Run, demo_msgs: Path) -> None:
    assert complete("show", "demo") == []
    write(Path("pyproject.toml"), '[tool.ifgen]\npaths = ["demo_msgs"]\n')
    types = ["plain,demo_msgs/msg/Pair", "plain,demo_msgs/msg/Pose", "plain,demo_msgs/srv/Move"]
    assert complete("show", "demo") == complete("hash", "demo_m") == ["plain,demo_msgs", *types]
    assert complete("show", "demo_msgs/msg/Po") == ["plain,demo_msgs/msg/Pose"]
    assert complete("templates", "context", "std_msgs/msg/Stri") == ["plain,std_msgs/msg/String"]
    assert len(complete("show", "")) > 200
    write(Path("vendor/their_msgs/msg/A.msg"), "int8 a\n")
    assert complete("show", "-I", "vendor", "their") == ["plain,their_msgs", "plain,their_msgs/msg/A"]


def test_names_of_rules_and_templates(complete: Run) -> None:
    assert complete("rules", "keyw") == ["plain,keyword-name"]
    assert complete("templates", "export", "al") == ["plain,all"]
    assert complete("templates", "list", "message_package/pack") == ["plain,message_package/package.py.j2"]


def test_what_is_wrong_is_no_completion(complete: Run) -> None:
    write(Path("pyproject.toml"), '[tool.ifgen]\npaths = ["nowhere"]\n')
    assert complete("show", "std_msgs/msg/Str") == []
    write(Path("pyproject.toml"), '[tool.ifgen]\npaths = ["empty"]\n')
    Path("empty").mkdir()
    assert "plain,std_msgs/msg/String" in complete("show", "std_msgs/msg/Str"), "installed ones can be had"


def test_in_a_bash(ifgen: Run) -> None:
    script = ifgen("completion", "bash").out
    lines = [
        script,
        f"ifgen() {{ {sys.executable} -m ifgen; }}; env() {{ local -x \"${{@:1:3}}\"; ifgen; }}",
        'ask() { COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=(); _ifgen_completion ifgen; echo "${COMPREPLY[@]}"; }',
        "ask ifgen templ; ask ifgen show std_msgs/msg/Col",
    ]  # fmt: skip
    found = subprocess.run(
        ["bash", "--norc", "-c", "\n".join(lines)], capture_output=True, text=True, timeout=60, check=False
    )
    assert (found.stdout, found.stderr) == ("templates\nstd_msgs/msg/ColorRGBA\n", "")


@pytest.mark.parametrize(("shell", "said"), [("zsh", "#compdef ifgen"), ("fish", "complete ")])
def test_scripts_of_other_shells(ifgen: Run, shell: str, said: str) -> None:
    assert said in ifgen("completion", shell).out


def test_options_that_there_are_not(ifgen: Run) -> None:
    def said(*words: str) -> str:
        done = ifgen(*words)
        assert (done.code, done.out) == (2, "")
        return done.err

    assert said("generate", "--outpt", "x") == (
        "error: no such option '--outpt'\n  = help: did you mean '--output'? see `ifgen generate --help`\n"
    )
    assert "--paramtype'\n  = help: did you mean '--param-type' or '--param-prefixes'?" in said(
        "param", "list", "--paramtype"
    )
    assert "did you mean '--check'?" in said("generate", "--dry-run")
    assert "did you mean 'generate' or 'generators'?" in said("generat")
    assert "did you mean 'templates'?" in said("tempaltes")
    assert "did you mean" not in said("zzz")
    assert said("completion") == (
        "error: missing argument '{bash|zsh|fish}'. Choose from: bash, zsh, fish\n"
        "  = help: see `ifgen completion --help`\n"
    )
    for command in ("generate", "graph", "check", "show", "hash"):
        long = {"generate": ("--output", "--include"), "graph": ("--output", "--include")}
        assert all(option in ifgen(command, "--help").out for option in long.get(command, ("--include",)))
    assert ifgen("-V").out == ifgen("--version").out
