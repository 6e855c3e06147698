"""Who prints, who writes files, and why an import is late: true as docs/architecture.md says it."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pytest

ROOT: Final = Path(__file__).resolve().parents[2]
CODE: Final = ROOT / "codegen"
HOUSE: Final = tuple(
    f"codegen/{room}"
    for room in ("ifgen", "ifgen_pytest", "ifgen_runtime", "ifgen_tools", "underlay", "libraries")
)

WRITERS: Final = {
    "ifgen/cli/new.py": "files that do not exist yet",
    "ifgen/command_kit/completion.py": "the null device, in place of stderr",
    "ifgen/command_kit/terminal.py": "the null device, in place of an output that is closed",
    "ifgen/generator_py/templates/exports.py": "the folder that `transaction` fills",
    "ifgen/writing": "all that commands generate, fix or remove",
    "ifgen_pytest/fixtures.py": "the folder of a test's bag",
    "ifgen_pytest/recording.py": "the bags of failed tests",
    "ifgen_runtime/bag": "bags",
    "ifgen_runtime/domains/neighbours.py": "its socket",
    "ifgen_tools/bag/files.py": "the place of a copied bag",
    "ifgen_tools/beside.py": "a note by which the programs that it starts know of each other",
    "ifgen_tools/graph/commands.py": "the picture that was asked for",
    "ifgen_tools/conformance/commands.py": "the report that was asked for",
    "libraries/launch": "logs, and parameters for processes",
    "ifgen_tools/launching/installed.py": "an index of ament for the time of a launch",
    "ifgen_tools/nodl/document_verbs.py": "the document that was asked for",
    "ifgen_tools/nodl/node_verbs.py": "the document that was asked for",
    "ifgen_tools/nodl/observation.py": "the message that was asked for",
    "ifgen_tools/policy/commands.py": "the policy that was asked for",
    "ifgen_tools/running/processes.py": "a note by which the programs that it starts know of each other",
    "ifgen_tools/top/screen/frame.py": "no file: `truncate` of a line",
    "underlay/rclpy/impl/rcl/log_outputs.py": "the log",
    "underlay/rmw_local/reader.py": "no file: `touch` of a deadline",
    "underlay/rmw_local/transports/doorbell.py": "sockets, in a folder for the user's",
    "underlay/rmw_local/transports/memory.py": "shared memory",
    "underlay/rmw_local/writer.py": "no file: `touch` of a deadline",
    "ifgen/cli/generators.py": "folders that `transaction` fills",
    "ifgen/pipeline/generators/kit.py": "the folder that `transaction` fills",
}
"""Who writes, and what; by file or room below codegen."""

_WRITE: Final = {
    *("NamedTemporaryFile", "TemporaryDirectory", "chmod", "copy2", "copyfile", "copytree", "hardlink_to"),
    *("makedirs", "mkdir", "mkdtemp", "mkstemp", "rename", "rmdir", "rmtree", "symlink_to", "touch"),
    *("truncate", "unlink", "write_bytes", "write_text"),
}
_WRITING_MODE: Final = re.compile(r"""['"][rwxabt]*[wxa+][rwxabt+]*['"]|O_(WRONLY|RDWR|CREAT)""")
_NO_REASON: Final = re.compile(r"# (type: ignore|noqa|pyright:)")


def modules(*folders: str) -> Iterator[Path]:
    for folder in folders:
        yield from sorted((ROOT / folder).rglob("*.py"))


def writes(tree: ast.AST) -> bool:
    """Whether code changes a file or a folder."""
    for call in (node for node in ast.walk(tree) if isinstance(node, ast.Call)):
        name = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
        moves = name == "replace" and len(call.args) == 1 and not call.keywords  # Path.replace, not str's
        opens = name == "open" and _WRITING_MODE.search(ast.unparse(call))
        if name in _WRITE or moves or opens:
            return True
    return False


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("path.write_text('a')", True),
        ("path.open('x')", True),
        ("open(path, mode='ab')", True),
        ("os.open(path, os.O_RDWR)", True),
        ("temporary.replace(path)", True),
        ("text.replace('a', 'b')", False),
        ("replace(value, field=1)", False),
        ("path.open('rb')", False),
        ("os.open(path, os.O_RDONLY)", False),
    ],
)
def test_what_counts_as_writing(text: str, expected: bool) -> None:
    assert writes(ast.parse(text)) is expected


def below(place: str, name: str) -> bool:
    """Whether a file is a place, or in it."""
    return name == place or name.startswith(f"{place}/")


def names_of(found: Iterator[Path]) -> set[str]:
    return {path.relative_to(CODE).as_posix() for path in found}


def test_only_these_write() -> None:
    found = names_of(path for path in modules(*HOUSE) if writes(ast.parse(path.read_text())))
    assert {name for name in found if not any(below(place, name) for place in WRITERS)} == set()
    assert {place for place in WRITERS if not any(below(place, name) for name in found)} == set()


STREAMS: Final = {
    "ifgen/cli": "commands",
    "ifgen/command_kit": "commands",
    "ifgen_tools/nodl/document_verbs.py": "click.echo, which is as `print`",
    "ifgen_tools/nodl/node_verbs.py": "click.echo, which is as `print`",
    "ifgen_tools/nodl/printing.py": "click.echo, which is as `print`",
    "ifgen_tools/policy/commands.py": "click.echo, which is as `print`",
    "ifgen_tools/top": "a screen",
    "ifgen_tools/topic/echo.py": "a line at a time, whoever reads",
    "libraries/launch/logging.py": "the output of processes, whose reader may have gone",
    "underlay/rmw_local": "notices, in a line each, where no logger is yet",
}
"""Who goes around `print`, which ruff finds (T20), and why; by file or room below codegen."""


def test_only_these_name_their_streams() -> None:
    named = re.compile(r"\bsys\.std(out|err)\.(write|buffer)|\bclick\.(echo|secho)|\bimport rich|\bfrom rich")
    found = names_of(path for path in modules(*HOUSE) if named.search(path.read_text()))
    assert {name for name in found if not any(below(place, name) for place in STREAMS)} == set()
    assert {place for place in STREAMS if not any(below(place, name) for name in found)} == set()


SILENT: Final = (
    "ros_graph",
    "verbs",
    "completion",
    "discovery",
    "types",
    "texts",
    "graph/layout",
    "bag/recorder",
    "param/client",
)
"""The tools' modules and rooms that return values, for verbs to print."""


def test_what_the_tools_share_does_not_print() -> None:
    for place in SILENT:
        path = CODE / "ifgen_tools" / place
        for file in sorted(path.rglob("*.py")) if path.is_dir() else [path.with_suffix(".py")]:
            assert not re.search(r"\bprint\(", file.read_text()), file


def late_imports(tree: ast.AST, late: bool = False) -> Iterator[ast.Import | ast.ImportFrom]:
    """The imports within functions."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Import | ast.ImportFrom) and late:
            yield node
        yield from late_imports(node, late or isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef))


def unexplained(text: str) -> Iterator[int]:
    """The lines of late imports without a reason.

    It stands on one of their lines, on the line above, beside the import that they continue, or for a whole
    module in a comment "Late imports: ...".
    """
    lines = text.splitlines()
    if any(line.startswith("# Late imports: ") for line in lines):
        return
    if not any(line.lstrip() != line and line.lstrip().startswith(("import ", "from ")) for line in lines):
        return  # which is quicker than to parse it
    explained = -1
    for node in late_imports(ast.parse(text)):
        own = lines[node.lineno - 1 : node.end_lineno]
        above = lines[node.lineno - 2].strip()
        continues = explained >= 0 and not any(line.strip() for line in lines[explained : node.lineno - 1])
        said = any("# " in line and not _NO_REASON.search(line) for line in own) or above.startswith("# ")
        if said or continues:
            explained = node.end_lineno or node.lineno
        else:
            yield node.lineno


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("    import a\n", [2]),
        ("    import a  # type: ignore\n", [2]),
        ("    import a  # slow\n    import b\n\n    from c import d\n", []),
        ("    import a  # slow\n    b()\n    import c\n", [4]),
        ("    # Slow.\n    import a\n", []),
        ("    if x:\n        from a import (\n            b,  # slow\n        )\n", []),
        ("    class C:\n        def g():\n            import a\n", [4]),
        ("    import a\n# Late imports: all of them are slow.\n", []),
    ],
)
def test_what_counts_as_a_reason(body: str, expected: list[int]) -> None:
    assert list(unexplained(f"def f():\n{body}")) == expected


def test_every_late_import_has_its_reason() -> None:
    paths = modules("codegen", "examples")
    found = [f"{path.relative_to(ROOT)}:{line}" for path in paths for line in unexplained(path.read_text())]
    assert found == []


def test_c_uses_no_formats_with_a_number_sign() -> None:
    """Compiled with the headers of CPython 3.13, they fail on 3.11 and 3.12, whatever the limited API is."""
    formats = re.compile(r'Py(?:Arg_Parse|_BuildValue|Object_Call)\w*\([^"]*"[^"]*[suyz]#')
    sources = sorted((ROOT / "codegen/native/src").glob("*.c"))
    assert sources
    assert not [path.name for path in sources if formats.search(path.read_text())]
