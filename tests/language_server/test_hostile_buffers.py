"""Half-written and broken texts: no request fails, and no place lies outside the text."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

pytest.importorskip("pygls")

from ifgen.diagnostics import InputError, Source
from ifgen.formatting import formatted
from ifgen.language_server import actions, completion, outline
from ifgen.language_server.hover import hover
from ifgen.language_server.positions import Positions
from ifgen.language_server.symbols import definition_of, symbols
from ifgen.language_server.workspace import Workspace

ROOT = Path(__file__).parents[2]
PIECES = (
    "\n",
    "\r\n",
    "\r",
    "\0",
    "\ufeff",
    "é",
    "𐀀",
    "#",
    "---\n",
    "[",
    "<=",
    "/",
    "=",
    " ",
    "\t",
    "'",
    "x" * 5000,
)
FILES = (
    "geometry_msgs/msg/Pose.msg",
    "std_srvs/srv/SetBool.srv",
    "example_interfaces/action/Fibonacci.action",
)
IDL = "module demo_msgs { module msg { struct Sample { double x; std_msgs::msg::Header h; }; }; };\n"
NODE = "nodl_version: 2\npublishers:\n  - {name: a, type: std_msgs/msg/String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}\n"


@pytest.mark.parametrize(
    "number", [pytest.param(40), pytest.param(2000, marks=[pytest.mark.slow, pytest.mark.timeout(900)])]
)
def test_mutated_buffers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int) -> None:
    chance = random.Random(number)
    texts = {
        f"demo_msgs/{name.partition('/')[2]}": (ROOT / "interfaces" / name).read_text() for name in FILES
    }
    texts |= {"demo_msgs/msg/Sample.idl": IDL, "demo_msgs/nodl/a.nodl.yaml": NODE}
    for name, text in texts.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    monkeypatch.chdir(tmp_path)
    workspace = Workspace(tmp_path)
    for _ in range(number):
        name = chance.choice(sorted(texts))
        text = texts[name]
        for _ in range(chance.randint(1, 5)):
            start = chance.randint(0, len(text))
            text = text[:start] + chance.choice(PIECES) + text[start + chance.randint(0, 4) :]
        ask_everything(workspace, tmp_path / name, text)


def test_a_long_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for text in ("x" * 2**20, "# " + "y " * 2**19, "int8 x " * 2**17):
        ask_everything(Workspace(tmp_path), tmp_path / "demo_msgs/msg/Long.msg", text)


def ask_everything(workspace: Workspace, path: Path, text: str) -> None:
    """Every request about a text; each place that comes out lies within it."""
    workspace.open(path, text)
    for finding in workspace.findings(path):
        if finding.primary is not None:
            span = finding.primary.span
            assert 0 <= span.start <= span.end <= len(span.source.text) + 1
            list(actions.quick_fixes(finding))
    source = workspace.source(path)
    assert source is not None
    positions = Positions(source.text, "utf-16")
    for symbol in list(symbols(workspace, source))[:4]:
        assert source.text[symbol.span.start : symbol.span.end]
        hover(workspace, symbol)
        definition_of(workspace, symbol)
    outline.document_symbols(workspace, source, positions)
    outline.folding_ranges(positions)
    outline.semantic_tokens(workspace, source, positions)
    outline.inlay_hints(workspace, source, positions, 0, positions.lines)
    lines = [positions.line(number) for number in range(positions.lines)]
    completion.completions(workspace, source, lines[-1], lines[:-1])
    try:
        formatted(Source(path, source.text))
    except InputError as error:
        assert "unsafe-format" not in {problem.rule for problem in error.diagnostics}
