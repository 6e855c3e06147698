"""Helpers: generate a tree of C or C++, compile it, and run it."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

from ifgen import resources
from ifgen.generators import Generator, Request, Response
from ifgen.model import Model
from ifgen.pipeline.model import load_model

from ...conformance.support import run_suite

ROOT = resources.PACKAGE.parents[1]
IFGEN = Path(sys.executable).with_name("ifgen")
WARNINGS = ["-Wall", "-Wextra", "-Wconversion", "-Wpedantic", "-Wshadow", "-Werror"]


def load(*paths: Path) -> Model:
    """The model of these interfaces and of all that they need."""
    return load_model(
        *paths, include=(ROOT / "interfaces", ROOT / "tests/conformance/interfaces"), with_deps=True
    )


def corpus(folder: Path) -> Model:
    """The model of the interfaces with every trap, which authors of generators get."""
    run([sys.executable, "-m", "ifgen", "generators", "test", "--corpus", str(folder)])
    return load(folder / "trap_msgs", folder / "other_msgs")


def generate(generator: Generator, model: Model, **options: Any) -> Response:
    """What a generator makes of a model."""
    defaults: Mapping[str, Any] = {option.name: option.default for option in generator.options}
    return (
        generator.generate(Request(model, {**defaults, **options}, "test"))
        if generator.generate
        else Response()
    )


def write(response: Response, folder: Path) -> Path:
    """Write the files of a response, which has no findings."""
    assert response.findings == ()
    for file in response.files:
        path = folder / file.path
        path.parent.mkdir(parents=True, exist_ok=True)
        assert isinstance(file.content, str)
        path.write_text(file.content, "utf-8")
    return folder


def build(
    folder: Path, compiler: Sequence[str], suffix: str, program: Path, link: Sequence[str] = ()
) -> Path:
    """Compile all files with this suffix, each on its own, and link them. Fails with what the compiler wrote."""
    sources = sorted(folder.rglob(f"*{suffix}"))
    with ThreadPoolExecutor(2) as pool:
        objects = list(pool.map(partial(_object, folder, compiler), sources))
    run([*compiler, *link, *map(str, objects), "-o", str(program)])
    return program


def _object(folder: Path, compiler: Sequence[str], source: Path) -> Path:
    result = source.with_suffix(f"{source.suffix}.o")
    run([*compiler, f"-I{folder}", f"-I{folder}/testee", "-c", str(source), "-o", str(result)])
    return result


def run(command: Sequence[str], cwd: Path | None = None) -> str:
    """The output of a program that succeeds."""
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


def passes(*testee: str) -> bool:
    """Whether a testee passes the conformance suite; shows what it prints if not."""
    code, text = run_suite(testee)
    assert code == 0, text
    return True
