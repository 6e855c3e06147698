"""The story in docs/adapters.md is what `ifgen adapt` does."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import ifgen as toolkit

from tests.cli.conftest import Git, Run, commit, write

ROOT = Path(__file__).resolve().parents[3]
PAGE = (ROOT / "docs/adapters.md").read_text()
BATTERY = Path("interfaces/robot_msgs/msg/BatteryState.msg")
TYPE = "robot_msgs/msg/BatteryState"


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)


def outputs() -> dict[str, str]:
    """What the page says that each command prints."""
    return dict(block[2:].partition("\n")[::2] for block in blocks("console"))


def definitions() -> tuple[str, str]:
    """Both versions of the battery, as docs/evolution.md has them."""
    page = (ROOT / "docs/evolution.md").read_text()
    lines = re.findall(r"^```diff\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)[0].splitlines()
    old, new = ([line[1:] for line in lines if line[:1] in {" ", sign}] for sign in "-+")
    return "\n".join(old) + "\n", "\n".join(new) + "\n"


def test_the_story(ifgen: Run, git: Git) -> None:
    old, new = definitions()
    write(Path("pyproject.toml"), '[tool.ifgen]\npaths = ["interfaces"]\n')
    write(BATTERY, old)
    commit(git)
    git("tag", "v1.0")
    write(BATTERY, new)
    toolkit.generate("interfaces", output="generated")
    command = f"adapt {TYPE} --from v1.0 --downgrade"
    assert ifgen(*command.split()).out == outputs()[f"ifgen {command}"]
    [module] = Path("adapters").glob("battery_state_*.py")
    text = module.read_text()
    assert text == blocks("python")[0]
    decided = apply(text, blocks("diff")[0])
    module.write_text(decided)
    command_line = [sys.executable, "-m", "pytest", "-q", "adapters", "--transport", "local"]
    done = subprocess.run(command_line, capture_output=True, text=True, timeout=120, check=False)
    assert "5 passed" in done.stdout
    commit(git)
    git("tag", "v2.0")
    write(BATTERY, new.replace("float32 current", "float64 current"))
    command = f"adapt {TYPE} --from v2.0"
    assert ifgen(*command.split()).out == outputs()[f"ifgen {command}"]


def apply(text: str, diff: str) -> str:
    """The text with the changes that a diff shows, which has no numbers of lines."""
    for hunk in diff.split("@@\n"):
        lines = hunk.splitlines()
        before, after = ("\n".join(line[1:] for line in lines if line[:1] in {" ", sign}) for sign in "-+")
        assert before in text, before
        text = text.replace(before, after)
    return text
