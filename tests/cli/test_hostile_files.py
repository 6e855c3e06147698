"""Hostile files where ifgen looks: pipes, devices, huge or deep ones. At most one error, and soon."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from .conftest import Run, write

pytestmark = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes with names")

CONFIGURATION = "pyproject.toml"
MANIFEST = "generated/demo_msgs/.ifgen-manifest.json"
MODULE = "generated/demo_msgs/msg/_pose.py"
COMMANDS = (("check",), ("generate",), ("templates", "check"))


def endless(path: Path) -> None:
    path.symlink_to("/dev/zero")


def huge(path: Path) -> None:
    path.touch()
    os.truncate(path, 2**33)


FILES = [
    *(CONFIGURATION, MANIFEST, MODULE, "filters.py", "templates/message_package/interface.py.j2"),
    *("demo_msgs/package.xml", "demo_msgs/CMakeLists.txt", "demo_msgs/msg/Other.msg"),
    "demo_msgs/nodl/driver.nodl.yaml",
]


def with_each_file() -> Iterator[Any]:
    """Each file in each way: the first file as a huge one, the second as a pipe and so on are quick enough."""
    makes = [os.mkfifo, endless, huge]
    for number, file in enumerate(FILES):
        for make in makes:
            slow = [] if make is makes[number % len(makes) - 1] else [pytest.mark.slow]
            yield pytest.param(file, make, id=f"{file}-{make.__name__}", marks=slow)


@pytest.mark.parametrize(("file", "make"), [*with_each_file()])
def test_what_is_no_file_of_a_sensible_size_is_not_read(
    ifgen: Run, demo_msgs: Path, file: str, make: Callable[[Path], None]
) -> None:
    """Outcome checks that there is no traceback, and pytest limits the time."""
    configured = '[tool.ifgen]\npaths = ["demo_msgs"]\ntemplates = "templates"\nfilters = "filters.py"\n'
    write(Path(CONFIGURATION), configured)
    write(Path("filters.py"), "")
    Path("templates").mkdir()
    assert ifgen("generate").code == 0
    place = Path(file)
    place.parent.mkdir(parents=True, exist_ok=True)
    place.unlink(missing_ok=True)
    make(place)
    for command in COMMANDS:
        done = ifgen(*command)
        assert done.code in {0, 1, 2}
        assert done.err.count("error") <= 3
    shutil.rmtree("generated")  # the huge ones


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("paths = " + "[" * 5000, "lists or tables are nested too deeply"),
        (".".join(["a"] * 20_000) + " = 1", "a key has more than 100 parts"),
        ("x = {" + ' . "a b"' * 20_000 + " = 1}", None),
        ("a" * 2_000_000, None),
        ("x = " + "9" * 5000, "a number has thousands of digits"),
        ('output = "a\\u0000b"', "'output' in [tool.ifgen] must be a path without NUL"),
        ('paths = ["a\\u0000b"]', "'paths' in [tool.ifgen] must be a path without NUL"),
        ('templates = "a\\u0000b"', "'templates' in [tool.ifgen] must be a path without NUL"),
        ('filters = "a\\u0000b"', "'filters' in [tool.ifgen] must be a path without NUL"),
    ],
    ids=["lists", "parts", "quoted-parts", "word", "digits", "output", "paths", "templates", "filters"],
)
def test_a_configuration_beyond_measure(ifgen: Run, demo_msgs: Path, text: str, why: str | None) -> None:
    write(Path(CONFIGURATION), f"[tool.ifgen]\n{text}\n")
    done = ifgen("generate", demo_msgs)
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith("error[configuration]: ")
    assert why is None or why in done.err
    assert "\0" not in done.err


def test_what_is_no_key(ifgen: Run, demo_msgs: Path) -> None:
    """Long words, numbers and texts with dots are ignored."""
    numbers = ", ".join(["0.1"] * 1000)
    ninety = ".".join(["a"] * 90)
    write(Path(CONFIGURATION), f'[tool.ifgen]\n[tool.{ninety}]\nx = [{numbers}]\ny = "{"." * 500}"\n')
    assert ifgen("check", demo_msgs).code == 0


def test_a_manifest_that_is_nested_too_deeply(ifgen: Run, demo_msgs: Path) -> None:
    ifgen("generate", demo_msgs)
    write(Path(MANIFEST), "[" * 100_000)
    expected = f"error[broken-manifest]: {MANIFEST} is broken: it is nested too deeply\n"
    assert ifgen("generate", demo_msgs).err.startswith(expected)


def test_notes_that_are_nested_too_deeply(ifgen: Run, demo_msgs: Path, cache_folder: Path) -> None:
    write(Path(CONFIGURATION), '[tool.ifgen]\npaths = ["demo_msgs"]\n')
    ifgen("generate")
    notes = [path for path in cache_folder.rglob("*.json") if path.is_file()]
    assert {path.parent.name for path in notes} == {"config", "generated"}
    for path in notes:
        path.write_text("[" * 100_000)
    assert ifgen("generate").code == 0


def test_a_template_that_is_nested_too_deeply(ifgen: Run, demo_msgs: Path) -> None:
    name = "message_package/interface.py.j2"
    write(Path("templates") / name, "{{ " + "(" * 20_000 + "1" + ")" * 20_000 + " }}")
    write(Path(CONFIGURATION), '[tool.ifgen]\ntemplates = "templates"\n')
    assert "nested too deeply" in ifgen("generate", demo_msgs).err
    assert ifgen("templates", "list").code == 0
