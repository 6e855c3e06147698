"""Every row of docs/rosidl-differences.md holds, on rosidl and on ifgen."""

from __future__ import annotations

import contextlib
import io
import json
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from ifgen import resources
from ifgen.definition.resolve import resolve
from ifgen.definition.type_description import described_types, type_hash
from ifgen.diagnostics import Diagnostic, InputError
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath

from . import idl_reference
from .conftest import Answer, Ours, Reference, Refused, comparable, decode

PAGE = Path(__file__).parents[2] / "docs" / "rosidl-differences.md"
SEVERAL_FILES = "More than one file"
CMAKE = "What CMakeLists.txt passes"  # whose rows are run in tests/reading/cmake
IDL = "idl-"
SHARE = Path(sys.prefix) / "share"


@dataclass(frozen=True)
class Row:
    """A row of one of the tables."""

    id: str
    input: str
    rosidl: str
    ifgen: str


def _rows(in_several_files: bool) -> Iterator[Row]:
    for section in PAGE.read_text(encoding="utf-8").split("\n## ")[1:]:
        if section.startswith(SEVERAL_FILES) == in_several_files and not section.startswith(CMAKE):
            for line in section.split("\n"):
                if line.startswith("| ") and not line.startswith("| id "):
                    id_, input_, rosidl, ifgen, why = line.strip("| ").split(" | ")
                    assert why, "every difference has its reason"
                    yield Row(id_, input_, rosidl, ifgen)


ROWS = [pytest.param(row, id=row.id) for row in _rows(in_several_files=False)]


@pytest.mark.parametrize("row", ROWS)
def test_row(row: Row, ours: Ours, rosidl: Reference) -> None:
    """The row is true for both; with `accepts` or `reads` on one side only, both read the same."""
    text = decode(_code(row.input)[0])
    kind = "srv" if "\n---\n" in text else "msg"
    if row.id.startswith(IDL):
        text = idl_reference.framed(text)
        mine, problems = idl_reference.ours("msg", text)
    else:
        mine, problems = ours.answer(kind, text), ours.problems(kind, text)
    said = [f"{problem.severity}[{problem.rule}]" for problem in (*problems.errors(), *problems.warnings())]
    rules = [code for code in _code(row.ifgen) if code.startswith(("error[", "warning["))]
    assert said == rules
    if row.rosidl == "hangs":
        _check_hangs(text)
        return
    theirs = idl_reference.rosidl("msg", text) if row.id.startswith(IDL) else rosidl.full(kind, text)
    if " in rosidl_" in row.rosidl:
        assert isinstance(theirs, Refused)
        stage = row.rosidl.rpartition(" in ")[2]
        assert theirs.why.startswith(
            (f"{stage}: {_code(row.rosidl)[0]}:", f"{stage}: {_code(row.rosidl)[0]} ")
        )
        assert isinstance(mine, Refused) == said[0].startswith("error")
        return
    if row.rosidl.startswith("reads "):
        assert _code(row.rosidl)[0] in _readings(theirs)
    else:
        assert row.rosidl == "accepts"
        assert not isinstance(theirs, Refused)
    if "reads " in row.ifgen:
        assert _code(row.ifgen)[-1] in _readings(mine)
        assert _code(row.ifgen)[-1] not in _readings(theirs)
    elif not isinstance(mine, Refused):
        same = (
            mine == theirs if row.id.startswith(IDL) else comparable(mine, kind) == comparable(theirs, kind)
        )
        assert same != ("keeps" in row.ifgen)


def _code(cell: str) -> list[str]:
    return re.findall("`([^`]+)`", cell)


def _readings(answer: Answer) -> set[str]:
    """The first field and the first constant as read, in Python text: type, value, comment, unit."""
    assert not isinstance(answer, Refused)
    message = answer[0]
    definitions = [*message.fields[:1], *message.constants[:1]]
    readings = [reading for _, *more in definitions for reading in more] or [message.fields]
    return {repr(reading) for reading in (*readings, message.comment)}


def _check_hangs(text: str) -> None:
    """The adapter is still busy after two seconds, a thousand times as long as it takes for a good line."""
    program = (
        "import sys; from rosidl_adapter.parser import parse_message_string as p; p('a', 'B', sys.argv[1])"
    )
    with pytest.raises(subprocess.TimeoutExpired):
        subprocess.run([sys.executable, "-c", program, text], timeout=2, capture_output=True, check=False)


FILES: dict[str, dict[str, str]] = {
    "unknown-type": {"demo_msgs/msg/Demo.msg": "std_msgs/Hader header\n"},
    "unknown-package": {"demo_msgs/msg/Demo.msg": "nowhere_msgs/Pose pose\n"},
    "recursive-type": {"demo_msgs/msg/Demo.msg": "Demo[] children\n"},
    "same-module": {"demo_msgs/msg/GPSFix.msg": "", "demo_msgs/msg/GpsFix.msg": ""},
    "same-type": {"demo_msgs/srv/Sample.srv": "---\n", "demo_msgs/srv/Sample_Request.srv": "---\n"},
    "wrong-folder": {"demo_msgs/msg/Add.srv": "---\n"},
    "python-constant": {"demo_msgs/msg/None.msg": ""},
    "lower-case-type": {
        "demo_msgs/msg/demo.idl": "module demo_msgs { module msg { struct demo { long a; }; }; };"
    },
    "two-files": {
        "demo_msgs/msg/Demo.msg": "uint8 a\n",
        "demo_msgs/msg/Demo.idl": "module demo_msgs { module msg { struct Demo { long a; }; }; };",
    },
}


@pytest.mark.parametrize("row", [pytest.param(row, id=row.id) for row in _rows(in_several_files=True)])
def test_row_of_several_files(row: Row, rosidl: Reference, tmp_path: Path) -> None:
    """The row is true for both."""
    files = FILES[row.id]
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    assert {f"error[{diagnostic.rule}]" for diagnostic in _diagnostics(tmp_path)} == set(_code(row.ifgen))
    failure = _failure_of_type_hash(tmp_path / "demo_msgs", [name.partition("/")[2] for name in files])
    if row.rosidl.startswith("accepts"):
        assert failure is None
    else:
        assert failure == _code(row.rosidl)[0]


def test_rosidl_overwrites_what_has_the_same_name(rosidl: Reference, tmp_path: Path) -> None:
    """Two interfaces of one module, or two types of one name, produce fewer files than they should."""
    assert _hashed(tmp_path / "a", ["srv/Sample.srv", "srv/Sample_Request.srv"]) == 7  # of 8 types
    from rosidl_pycommon import convert_camel_case_to_lower_case_underscore as module_name

    assert module_name("GPSFix") == module_name("GpsFix")


@pytest.mark.parametrize("folder", ["idl", "types", "more/idl"])
@pytest.mark.parametrize(
    ("kind", "structs"), [("msg", ["Demo"]), ("srv", ["Demo_Request", "Demo_Response"])], ids=["msg", "srv"]
)
def test_an_idl_file_can_be_in_any_folder(
    folder: str, kind: str, structs: list[str], rosidl: Reference, tmp_path: Path
) -> None:
    """Its module says what it is, and the hash is the same for both."""
    package, name = tmp_path / "demo_msgs", f"{folder}/Demo.idl"
    (package / folder).mkdir(parents=True)
    members = " ".join(f"struct {struct} {{ float range; }};" for struct in structs)
    (package / name).write_text(f"module demo_msgs {{ module {kind} {{ {members} }}; }};\n")
    (package / "package.xml").write_text("<package><name>demo_msgs</name></package>\n")
    (package / "CMakeLists.txt").write_text(
        f'project(demo_msgs)\nrosidl_generate_interfaces(${{PROJECT_NAME}} "{name}")\n'
    )
    packages = find_packages([package])
    registry = resolve(packages, SearchPath([*packages, *find_packages([resources.bundled_interfaces()])]))
    interface = registry.interface(f"demo_msgs/{kind}/Demo")
    mine = {each.type_name: type_hash(each, registry) for each in described_types(interface)}
    theirs: dict[str, str] = {}
    for description in _type_hashes(package, [name]):
        hashes = json.loads(Path(description).read_text())["type_hashes"]
        theirs |= {item["type_name"]: item["hash_string"] for item in hashes}
    assert mine.items() <= theirs.items()


def _diagnostics(folder: Path) -> tuple[Diagnostic, ...]:
    packages = find_packages([folder])
    try:
        resolve(packages, SearchPath(packages))
    except InputError as error:
        return error.diagnostics
    return ()


def _failure_of_type_hash(package: Path, files: list[str]) -> str | None:
    """The exception with which rosidl fails to hash the files of a package, if it does."""
    try:
        _type_hashes(package, files)
    except Exception as error:
        return type(error).__name__
    return None


def _hashed(package: Path, files: list[str]) -> int:
    for name in files:
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text("---\n")
    return len({path.name for path in map(Path, _type_hashes(package, files))})


def _type_hashes(package: Path, files: list[str]) -> list[Any]:
    """Run rosidl on the files of a package up to their type descriptions, as its build does."""
    from rosidl_adapter import convert_to_idl
    from rosidl_generator_type_description import generate_type_hash

    output = package.parent / "output"
    output.mkdir()
    arguments: dict[str, Any] = {
        "package_name": "demo_msgs",
        "output_dir": str(output),
        "idl_tuples": [],
        "include_paths": [f"{path.name}:{path}" for path in SHARE.iterdir() if path.is_dir()],
    }
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        for name in files:
            if name.endswith(".idl"):
                arguments["idl_tuples"].append(f"{package}:{name}")
                continue
            converted = convert_to_idl(package, "demo_msgs", Path(name), output / "idl")
            relative = Path(converted).relative_to(output / "idl")
            arguments["idl_tuples"].append(f"{output / 'idl'}:{relative}")
        (output / "arguments.json").write_text(json.dumps(arguments))
        return list(generate_type_hash(str(output / "arguments.json")))
