"""docs/meaning.md: its files are written, and its commands print what the page says."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

PAGE = (Path(__file__).parents[3] / "docs/meaning.md").read_text(encoding="utf-8")


def ifgen(folder: Path, *arguments: str, **environment: str) -> str:
    command = [sys.executable, "-m", "ifgen", *arguments]
    ran = subprocess.run(
        command,
        cwd=folder,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    return ran.stdout + ran.stderr


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)


def test_the_commands(tmp_path: Path) -> None:
    (definition,) = blocks("msg")
    typo = re.search(r"echo '(.*)' >", PAGE)
    assert typo is not None
    for name, text in (("demo_msgs", definition), ("typo_msgs", f"{typo[1]}\n")):
        path = tmp_path / name / "msg" / "Wheel.msg"
        path.parent.mkdir(parents=True)
        path.write_text(text)
    shown, checked, warned = (block.partition("\n$ ifgen check typo_msgs") for block in blocks("console"))
    assert ifgen(tmp_path, "show", "-I", ".", "demo_msgs/msg/Wheel") == shown[0].partition("\n")[2]
    assert checked[2].strip() in ifgen(tmp_path, "check", "typo_msgs")
    (program,) = blocks("python")
    (tmp_path / "drive.py").write_text(program)
    ifgen(tmp_path, "generate", "demo_msgs", "-o", "generated", "-q")
    module = (tmp_path / "generated/demo_msgs/msg/_wheel.py").read_text()
    annotation = re.search(r"^ +speed: .*$", PAGE, re.MULTILINE)
    assert annotation is not None and annotation[0].strip() in module
    run = ("run", "--transport", "local", "drive.py")
    said = ifgen(tmp_path, *run, IFGEN_CHECK_FIELDS="1")
    assert re.sub(r"\[\d+\.\d+\] ", "", said) == warned[0].partition("\n")[2]
    assert ifgen(tmp_path, *run, IFGEN_CHECK_FIELDS="") == ""
