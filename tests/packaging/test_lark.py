"""`lark` and `lark-parser` install the same package: ifgen works with whichever was installed last.

The ros wheels bring lark-parser 0.12, which overwrites the files of lark 1.x and is overwritten by them.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from .support import ROOT, attempt, environment, install, run

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not (ROOT / "pyproject.toml").exists(), reason="no checkout"),
]

NEW, OLD = "lark>=1.1.9", "lark-parser==0.12.0"
PACKAGE = {
    "msg/Pose.msg": "# A pose.\nstd_msgs/Header header\nfloat64[3] position [1.0, 2.5, -3e2]\nstring<=5 name 'it\\'s'\n",
    "srv/Move.srv": "uint8 FAST=0x1f\nPose[<=4] through # on the way\n---\nbool ok true\n",
    "action/Go.action": "Pose goal\n---\n---\nfloat32 left\n",
    "msg/Letter.idl": """#include "std_msgs/msg/Header.idl"
module demo_msgs { module msg {
  module Letter_Constants { const char FIRST = 65; const string GREETING = "a" "\\x62"; };
  @verbatim (language="comment", text="A letter.") /* as in a book */
  struct Letter { std_msgs::msg::Header header; @key @default (value="(66, 67)") char text[2]; };
}; };
""",
}
BROKEN = {
    "Broken.msg": "int32 x\nint32 = 3\nfloat64 y 1.0.0\n",
    "BrokenToo.idl": "module demo_msgs { module msg {\n  struct BrokenToo { double x[ ]; };\n}; };\n",
    "Brackets.idl": "module demo_msgs { module msg {\n  struct Brackets { double[3] x; };\n}; };\n",
    "Mark.idl": "module demo_msgs { module msg {\n  struct Mark { double x; $ };\n}; };\n",
}


@pytest.fixture(scope="module")
def seen(wheels: tuple[Path, Path], tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[object]]:
    """The user's view after each installation, one over another, in two environments with one cache each."""
    orders: dict[str, list[object]] = {}
    for name, order in (("new first", (NEW, OLD, NEW)), ("old first", (OLD, NEW))):
        folder = tmp_path_factory.mktemp("lark")
        python = environment(folder / "venv", *wheels)
        orders[name] = []
        for requirement in order:
            install(python, "--no-deps", "--force-reinstall", requirement)
            major = run(python, "-c", "import lark; print(lark.__version__, lark.__file__)", cwd=folder)
            assert major.startswith("0.12" if requirement == OLD else "1."), major
            assert str(folder) in major
            orders[name].append(use(python, folder))
    return orders


def use(python: Path, folder: Path) -> object:
    """Output, exit codes and files of the commands that parse."""
    definitions = folder / "interfaces" / "demo_msgs"
    for name, text in PACKAGE.items():
        (definitions / name).parent.mkdir(parents=True, exist_ok=True)
        (definitions / name).write_text(text)
    broken = folder / "broken" / "demo_msgs" / "msg"
    broken.mkdir(parents=True, exist_ok=True)
    for name, text in BROKEN.items():
        (broken / name).write_text(text)
    ifgen = python.with_name("ifgen")
    output = folder / "out"
    shutil.rmtree(output, ignore_errors=True)
    said = run(ifgen, "generate", "-o", output, "interfaces", cwd=folder).replace(str(folder), "")
    files = {
        str(path.relative_to(output)): path.read_text()
        for path in sorted(output.rglob("*"))
        if path.is_file() and "__pycache__" not in path.parts
    }
    checked = attempt(ifgen, "check", "broken", cwd=folder)
    assert checked.returncode == 1 and "Traceback" not in checked.stderr, checked.stderr
    return (
        said,
        run(ifgen, "hash", "std_msgs/msg/String", cwd=folder),
        run(ifgen, "show", "sensor_msgs/msg/JointState", cwd=folder),
        files,
        checked.stdout + checked.stderr,
    )


@pytest.mark.parametrize("order", ["new first", "old first"])
def test_installing_the_other_lark_over_it_changes_nothing(order: str, seen: dict[str, list[object]]) -> None:
    first = seen["new first"][0]
    for after in seen[order]:
        assert after == first
    said, hashed, shown, files, complaint = first
    assert "files written" in said
    assert hashed.startswith("std_msgs/msg/String RIHS01_df668c74")
    assert "position" in shown
    assert len([name for name in files if name.endswith(".py")]) >= 6
    assert any(name.endswith("_letter.py") for name in files)
    for place in ("Broken.msg:2:", "Broken.msg:3:", "BrokenToo.idl:2:", "Brackets.idl:2:", "Mark.idl:2:"):
        assert place in complaint
