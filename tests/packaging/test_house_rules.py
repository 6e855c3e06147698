"""Who prints, who writes files, and why an import is late: true as docs/architecture.md says it."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pytest

ROOT: Final = Path(__file__).resolve().parents[2]
TOOLKIT: Final = ROOT / "codegen/ifgen"

WRITERS: Final = {
    "cli/generators.py": "folders that `transaction` fills",
    "cli/new.py": "files that do not exist yet",
    "command_kit/completion.py": "the null device, in place of stderr",
    "command_kit/terminal.py": "the null device, in place of an output that is closed",
    "generator_py/templates/exports.py": "the folder that `transaction` fills",
    "pipeline/generators/kit.py": "the folder that `transaction` fills",
}
"""Who writes besides the room `writing`, and what; by file below codegen/ifgen."""

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


def test_only_these_write() -> None:
    found = {
        name
        for path in modules("codegen/ifgen")
        if not (name := path.relative_to(TOOLKIT).as_posix()).startswith("writing/")
        and writes(ast.parse(path.read_text()))
    }
    assert found == WRITERS.keys()


def test_only_the_command_line_names_its_streams() -> None:
    """`print` is ruff's to find (T20); this is all that goes around it."""
    named = re.compile(r"\bsys\.std(out|err)\.write|\bclick\.(echo|secho)|\bimport rich|\bfrom rich")
    found = {
        path.relative_to(TOOLKIT).parts[0]
        for path in modules("codegen/ifgen")
        if named.search(path.read_text())
    }
    assert found == {"cli", "command_kit"}


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
