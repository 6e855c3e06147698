"""Completion of names in shells: of types, and of what runs."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from ifgen_pytest.domains import own_domain

from tests.cli.conftest import Run
from tests.tools.transcript import environment, playing


@pytest.fixture
def complete(ifgen: Run, monkeypatch: pytest.MonkeyPatch) -> Run:
    """`complete("topic", "ec")`: the candidates for the last word."""

    def ask(*words: str) -> list[str]:
        monkeypatch.setenv("_IFGEN_COMPLETE", "bash_complete")
        monkeypatch.setenv("COMP_WORDS", " ".join(("ifgen", *words)))
        monkeypatch.setenv("COMP_CWORD", str(len(words)))
        done = ifgen()
        assert (done.code, done.err) == (0, "")
        return [line.removeprefix("plain,") for line in done.out.split()]

    return ask


def test_commands_verbs_and_options(complete: Run) -> None:
    assert complete("topi") == ["topic"]
    assert complete("interface", "pack") == ["package", "packages"]
    assert complete("topic", "list", "--show") == ["--show-types"]
    assert complete("topic", "list", "--transport", "l") == ["local"]


def test_types_and_packages(complete: Run) -> None:
    assert complete("interface", "show", "std_msgs/msg/Str") == ["std_msgs/msg/String"]
    assert complete("interface", "proto", "std_srvs/srv/Set") == ["std_srvs/srv/SetBool"]
    assert complete("interface", "package", "std_s") == ["std_srvs"]
    assert complete("interface", "show", "nothing/") == []


def test_launch_files(complete: Run) -> None:
    folder = Path("src/bringup")
    (folder / "launch").mkdir(parents=True)
    (folder / "package.xml").write_text("<package format='3'><name>bringup</name></package>")
    for name in ("robot.launch.py", "sim.launch.xml"):
        (folder / "launch" / name).touch()
    assert complete("launch", "bri") == ["file,bri", "bringup"]
    assert complete("launch", "bringup", "") == ["robot.launch.py", "sim.launch.xml"]
    assert complete("launch", "bringup", "sim.launch.xml", "") == []


def test_what_is_wrong_is_no_completion(complete: Run, tmp_path: Path) -> None:
    Path("pyproject.toml").write_text('[tool.ifgen]\npaths = ["nowhere"]\n')
    assert complete("interface", "show", "std_msgs/msg/Str") == []


@pytest.fixture(scope="module")
def around() -> Iterator[dict[str, str]]:
    """The environment of a shell beside a running system on the local transport."""
    with own_domain() as domain:
        found = environment(domain)
        found["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{found['PATH']}"
        with playing("tuned", "local", found):
            yield found


LIVE = {
    "param get --transport local /demo/t": "/demo/tuned",
    "param get --transport local /demo/tuned frame.o": "frame.offset",
    "node info --transport local /pl": "/plain",
    "service type --transport local /plain/list_p": "/plain/list_parameters",
    "param set --transport local /demo/tuned frame.offset 0.1 frame.o": "frame.offset",
    "bag record --transport local /parameter_e": "/parameter_events",
}


def in_bash(line: str, around: dict[str, str]) -> str:
    program = (
        'eval "$(ifgen completion bash)"; read -ra COMP_WORDS <<< "$1"; COMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n'
        '_ifgen_completion ifgen; echo "${COMPREPLY[@]}"'
    )
    return shell(["bash", "--norc", "-c", program, "bash", line], around)


def in_fish(line: str, around: dict[str, str]) -> str:
    return shell(["fish", "-N", "-c", 'ifgen completion fish | source; complete -C "$argv[1]"', line], around)


def in_zsh(line: str, around: dict[str, str]) -> str:
    """Zsh completes in a terminal only; here its functions that would show candidates print them."""
    program = (
        "compdef() { :; }; compadd() { print -l $completions; }\n"
        'eval "$(ifgen completion zsh)"; words=(${=1}); CURRENT=$#words; _ifgen_completion'
    )
    return shell(["zsh", "-f", "-c", program, "zsh", line], around)


def shell(program: list[str], around: dict[str, str]) -> str:
    done = subprocess.run(program, env=around, capture_output=True, text=True, timeout=60, check=False)
    assert done.stderr == ""
    return done.stdout.strip()


@pytest.mark.slow
@pytest.mark.parametrize("line", LIVE)
def test_what_runs_in_bash(line: str, around: dict[str, str]) -> None:
    assert in_bash(f"ifgen {line}", around) == LIVE[line]


@pytest.mark.slow
def test_transitions_in_bash() -> None:
    with own_domain() as domain:
        around = environment(domain)
        around["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{around['PATH']}"
        with playing("managed", "local", around):
            assert in_bash("ifgen lifecycle set --transport local /demo/camera conf", around) == "configure"
            assert in_bash("ifgen lifecycle set --transport local /nobody conf", around) == ""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["zsh", "fish"])
def test_what_runs_in_other_shells(name: str, around: dict[str, str]) -> None:
    if shutil.which(name) is None:
        pytest.skip(f"{name} is not installed")
    ask = {"zsh": in_zsh, "fish": in_fish}[name]
    for line, expected in LIVE.items():
        assert ask(f"ifgen {line}", around) == expected
