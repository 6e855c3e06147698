"""docs/policy.md shows what the commands print."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path

import pytest
from ifgen.cli import main

from .conftest import HERE, ROOT
from .test_admit import end, manifest

PAGE = (ROOT / "docs/policy.md").read_text()


@pytest.mark.parametrize("block", re.findall(r"```console\n(.*?)```", PAGE, re.DOTALL))
def test_a_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], block: str
) -> None:
    shutil.copytree(HERE / "robot", tmp_path / "robot")
    shutil.copy(HERE / "robot.launch.py", tmp_path)
    arm = {"/arm": [end("publishers", "/joints", "sensor_msgs/msg/JointState")]}
    (tmp_path / "arm.lock").write_text(manifest(arm))
    (tmp_path / "robot.lock").write_text(manifest({"/base": [end("subscriptions", "/joints")]}))
    monkeypatch.chdir(tmp_path)
    command, _, printed = block.partition("\n")
    code = main.main(shlex.split(command.removeprefix("$ ifgen ")))
    done = capsys.readouterr()
    assert (done.out, done.err) == (printed, "")
    assert code == (1 if "rejected" in printed else 0)
