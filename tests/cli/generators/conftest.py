"""A project with an interface, and generators: programs, and packages with entry points."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Generator
from pathlib import Path
from textwrap import dedent

import pytest
from ifgen.pipeline.generators import find

from ..conftest import write

PROGRAM = """\
import json, sys
request = json.load(sys.stdin)
if request["request"] == "describe":
    answer = {"name": "mine", "version": "1.2", **DESCRIPTION}
else:
    types = [type for type in request["model"]["types"] if type["generate"]]
    answer = {"files": [{"path": type["id"] + ".txt", "text": type["type_hash"]} for type in types]}
    BODY
json.dump(answer, sys.stdout)
"""

Program = Callable[..., None]
Package = Callable[..., None]


@pytest.fixture
def program(tmp_path: Path) -> Program:
    """A project whose target is a program in Python, with these statements in it."""

    def make(body: str = "pass", description: str = "{}", text: str | None = None, **keys: object) -> None:
        write(tmp_path / "interfaces/a_msgs/msg/Dot.msg", "float64 x  # [m]\nwstring name\n")
        script = text if text is not None else PROGRAM
        script = script.replace("BODY", body).replace("DESCRIPTION", description)
        write(tmp_path / "generate.py", script)
        lines = (f"{key} = {json.dumps(value)}" for key, value in keys.items())
        command = json.dumps([sys.executable, "generate.py"])
        write(
            tmp_path / "pyproject.toml",
            '[tool.ifgen]\npaths = ["interfaces"]\npython = false\n'
            f'[tool.ifgen.generate.mine]\ncommand = {command}\nout = "out"\n' + "\n".join(lines) + "\n",
        )

    return make


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Generator[Package]:
    """An installed package with a generator, `theirs`: the text of its module, and other files."""

    def make(module: str, **files: str) -> None:
        place = tmp_path / "site"
        name = f"theirs_{tmp_path.name}"  # modules stay imported
        write(place / f"{name}/__init__.py", dedent(module))
        for file, text in files.items():
            write(place / name / file.replace("__", "/"), text)
        write(
            place / f"{name}-1.0.dist-info/METADATA", f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n"
        )
        write(
            place / f"{name}-1.0.dist-info/entry_points.txt",
            f"[ifgen.generators]\ntheirs = {name}:GENERATOR\n",
        )
        monkeypatch.syspath_prepend(place)
        find.installed.cache_clear()
        write(tmp_path / "interfaces/a_msgs/msg/Dot.msg", "float64 x  # [m]\n")
        write(
            tmp_path / "pyproject.toml",
            '[tool.ifgen]\npaths = ["interfaces"]\n'
            '[tool.ifgen.generate.docs]\nuse = "theirs"\nout = "docs"\n',
        )

    yield make
    find.installed.cache_clear()
