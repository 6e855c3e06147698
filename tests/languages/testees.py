"""The testees of all languages that ifgen writes, each with every type, built once in a run of tests."""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Final

import pytest
from ifgen_generators.c import GENERATOR as C
from ifgen_generators.cpp import GENERATOR as CPP

from ..conformance.support import PYTHON, TYPESCRIPT, node_modules, tool
from .c_family.support import WARNINGS, build, load, write
from .c_family.support import generate as files_of
from .support import ALL, TSCONFIG, generate, run

BOUNDS: Final = {"*.string": 512, "*.wstring": 64, "*.sequence": 8}
HUGE: Final = {"trap_msgs/msg/HugeBounds.text": 9, "trap_msgs/msg/HugeBounds.bytes": 9}
SANITIZED: Final = ("-fsanitize=address,undefined", "-fno-sanitize-recover")


def command_of(language: str, factory: pytest.TempPathFactory) -> list[str]:
    """The command that starts a testee; the test is skipped without its compiler."""
    own = factory.getbasetemp()
    folder = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "testees" / language
    folder.mkdir(parents=True, exist_ok=True)
    with _locked(folder / "lock"):
        done = folder / "command.json"
        if not done.exists():
            done.write_text(json.dumps(build_testee(language, folder, *ALL)))
    command: list[str] = json.loads(done.read_text())
    return command


def build_testee(language: str, folder: Path, *paths: Path) -> list[str]:
    """Build the testee for the interfaces at some paths, and return the command that starts it."""
    return _BUILDERS[language](folder, paths)


@contextmanager
def _locked(path: Path) -> Generator[None]:
    """Only one process at a time: the others wait for what it builds."""
    with path.open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def compiled_typescript(compiler: Path, source: Path) -> Path:
    """The folder with the JavaScript of a folder. Any complaint of tsc fails the test."""
    output = source.with_name(f"{source.name}-js")
    (source / "package.json").write_text('{"type": "module"}\n')
    options = TSCONFIG | {"rootDir": str(source), "outDir": str(output)}
    (source.parent / "tsconfig.json").write_text(
        json.dumps({"compilerOptions": options, "include": [str(source)]})
    )
    run([str(compiler), "-p", "."], source.parent)
    (output / "package.json").write_text('{"type": "module"}\n')
    return output


def _typescript(folder: Path, paths: Sequence[Path]) -> list[str]:
    compiler = node_modules(folder / "npm", TYPESCRIPT) / ".bin/tsc"
    output = compiled_typescript(compiler, generate(folder, "typescript", "ts", *paths, testee=True))
    return ["node", str(output / "testee.js")]


def _rust(folder: Path, paths: Sequence[Path]) -> list[str]:
    cargo = tool("cargo")
    crate = generate(folder, "rust", "rs", *paths, testee=True)
    run([cargo, "rustc", "--offline", "--quiet", "--lib", "--", "-D", "warnings"], crate)
    run([cargo, "build", "--offline", "--quiet"], crate)
    return [str(crate / "target/debug/testee")]


def _c(folder: Path, paths: Sequence[Path]) -> list[str]:
    model = load(*paths)
    huge = HUGE if any(package.name == "trap_msgs" for package in model.packages) else {}
    write(files_of(C, model, bounds={**BOUNDS, **huge}, testee=True), folder / "c")
    compiler = [tool("gcc"), "-std=c99", *WARNINGS, "-O1", *SANITIZED]
    return [str(build(folder / "c", compiler, ".c", folder / "program"))]


def _cpp(folder: Path, paths: Sequence[Path]) -> list[str]:
    write(files_of(CPP, load(*paths), testee=True), folder / "cpp")
    compiler = [tool("g++"), "-std=c++17", *WARNINGS, "-O0", *SANITIZED]
    return [str(build(folder / "cpp", compiler, ".cpp", folder / "program"))]


_BUILDERS: Final[Mapping[str, Callable[[Path, Sequence[Path]], list[str]]]] = {
    "python": lambda _, __: [*PYTHON, "ours"],
    "typescript": _typescript,
    "rust": _rust,
    "c": _c,
    "cpp": _cpp,
}
