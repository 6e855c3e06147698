"""Draws the pictures of the pages: `python docs/pictures.py`. With `--check` it compares them only.

Nothing in them is written here. rooms.svg has the floors of the import contract in pyproject.toml, the
imports that the modules make, and the first sentence of each room. message.svg has the steps that
architecture.md lists, and processes.svg those of processes.md. Their files exist.
"""

from __future__ import annotations

import ast
import re
import sys
import textwrap
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from itertools import groupby, permutations, product
from pathlib import Path
from typing import Final, NamedTuple

ROOT: Final = Path(__file__).resolve().parents[1]
DOCS: Final = ROOT / "docs"
TOOLKIT: Final = ROOT / "codegen/ifgen"
WIDTH: Final = 900

# The colours of GitHub's pages, light and dark: a picture has no background of its own.
_STYLE: Final = """
  text { font: 13px ui-sans-serif, system-ui, sans-serif; fill: #1f2328 }
  .name { font: 600 15px ui-monospace, monospace }
  .file { font: 12.5px ui-monospace, monospace }
  .small { font-size: 12px; fill: #59636e }
  rect { fill: #f6f8fa; stroke: #818b98 }
  .bound rect { fill: #ddf4ff; stroke: #0969da }
  path { fill: none; stroke: #59636e; stroke-width: 1.5; marker-end: url(#arrow) }
  marker path { fill: #59636e; stroke: none }
  @media (prefers-color-scheme: dark) {
    text { fill: #f0f6fc }
    .small { fill: #9198a1 }
    rect { fill: #151b23; stroke: #656c76 }
    .bound rect { fill: #121d2f; stroke: #4493f8 }
    path { stroke: #9198a1 }
    marker path { fill: #9198a1 }
  }
"""


class Box(NamedTuple):
    """A rectangle in a picture."""

    left: float
    top: float
    width: float
    height: float

    @property
    def middle(self) -> float:
        """Half way from left to right."""
        return self.left + self.width / 2

    @property
    def bottom(self) -> float:
        """Where it ends."""
        return self.top + self.height


def _svg(height: float, title: str, parts: Sequence[str]) -> str:
    arrow = '<path d="M0 0 L8 4 L0 8 z"/>'
    return "\n".join(
        (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height:g}" role="img">',
            f"<title>{escape(title)}</title>",
            f"<style>{_STYLE}</style>",
            '<defs><marker id="arrow" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" '
            f'orient="auto">{arrow}</marker></defs>',
            *parts,
            "</svg>\n",
        )
    )


def _text(x: float, y: float, text: str, css: str = "", anchor: str = "start") -> str:
    return f'<text x="{x:g}" y="{y:g}" class="{css}" text-anchor="{anchor}">{escape(text)}</text>'


def _box(box: Box) -> str:
    return f'<rect x="{box.left:g}" y="{box.top:g}" width="{box.width:g}" height="{box.height:g}" rx="6"/>'


def floors() -> list[list[str]]:
    """The rooms of the toolkit from top to bottom, as the import contract has them."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = project["tool"]["importlinter"]["contracts"]
    [layers] = [c["layers"] for c in contracts if c["type"] == "layers" and c.get("containers") == ["ifgen"]]
    return [line.split(" | ") for line in layers]


def _imports(tree: ast.AST) -> Iterator[str]:
    """The rooms that code imports from; what only type checkers import does not count."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] == "ifgen":
            _, _, rest = (node.module or "").partition(".")
            yield from [rest.partition(".")[0]] if rest else [alias.name for alias in node.names]
        if not (isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"):
            yield from _imports(node)


def imports(rooms: Sequence[str]) -> dict[str, set[str]]:
    """The rooms that each room imports from."""
    found: dict[str, set[str]] = {}
    for room in rooms:
        folder = TOOLKIT / room
        paths = folder.rglob("*.py") if folder.is_dir() else [folder.with_suffix(".py")]
        names = {name for path in paths for name in _imports(ast.parse(path.read_bytes()))}
        found[room] = (names & set(rooms)) - {room}
    return found


def _without_detours(arrows: Mapping[str, set[str]]) -> list[tuple[str, str]]:
    """The arrows that are not also a way of several arrows."""

    def reached(room: str) -> set[str]:
        return {far for near in arrows[room] for far in (near, *reached(near))}

    return [
        (room, other)
        for room, others in arrows.items()
        for other in sorted(others)
        if not any(other in reached(between) for between in others - {other})
    ]


def _first_sentence(room: str) -> str:
    path = TOOLKIT / room / "__init__.py"
    path = path if path.is_file() else (TOOLKIT / room).with_suffix(".py")
    text = ast.get_docstring(ast.parse(path.read_bytes())) or ""
    return text.partition("\n\n")[0].replace("\n", " ").partition(". ")[0].rstrip(".")


def _in_order(plan: list[list[str]], arrows: Sequence[tuple[str, str]]) -> list[list[str]]:
    """The same floors, each from left to right so that arrows are short and cross little."""

    def sideways(floors: Sequence[Sequence[str]]) -> float:
        at = {room: (i + 0.5) / len(floor) for floor in floors for i, room in enumerate(floor)}
        return sum(abs(at[one] - at[other]) for one, other in arrows)

    return [list(floor) for floor in min(product(*map(permutations, plan)), key=sideways)]


def rooms() -> str:
    """The picture of the rooms."""
    plan = floors()
    arrows = _without_detours(imports([room for floor in plan for room in floor]))
    plan = _in_order(plan, arrows)
    floor_of = {room: number for number, floor in enumerate(plan) for room in floor}
    boxes: dict[str, Box] = {}
    gap, margin, height, step = 28.0, 60.0, 62.0, 96.0
    for number, floor in enumerate(plan):
        width = (WIDTH - 2 * margin - gap) / 2
        start = margin if len(floor) > 1 else (WIDTH - width) / 2
        for index, room in enumerate(floor):
            boxes[room] = Box(start + index * (width + gap), 10 + number * step, width, height)
    parts = []
    for one, other in arrows:
        a, b = boxes[one], boxes[other]
        if floor_of[other] - floor_of[one] == 1:
            shift = 24 if b.middle > a.middle else -24 if b.middle < a.middle else 0
            start, end, half = a.middle + shift, b.middle - shift, (a.bottom + b.top) / 2
            way = f"M{start:g} {a.bottom:g} C{start:g} {half:g} {end:g} {half:g} {end:g} {b.top:g}"
        else:  # beside the floors between
            side = WIDTH - 24 if b.middle >= WIDTH / 2 else 24
            edge = [box.left + box.width * (side > WIDTH / 2) for box in (a, b)]
            top, foot = a.top + height / 2, b.top + height / 2
            way = f"M{edge[0]:g} {top:g} H{side:g} V{foot:g} H{edge[1]:g}"
        parts.append(f'<path d="{way}"/>')
    for room, box in boxes.items():
        parts += [_box(box), _text(box.left + 12, box.top + 21, room, "name")]
        lines = textwrap.wrap(_first_sentence(room), 54, max_lines=2, placeholder=" ...")
        parts += [_text(box.left + 12, box.top + 38 + 15 * i, line, "small") for i, line in enumerate(lines)]
    foot = 10 + len(plan) * step
    said = "An arrow: imports. What connects rooms that arrows connect already is not drawn."
    return _svg(
        foot + 12, "The rooms of ifgen", [*parts, _text(WIDTH / 2, foot - 8, said, "small", "middle")]
    )


_STEP: Final = 34.0
_CLASS: Final = "geometry_msgs/msg/_point.py"


class Step(NamedTuple):
    """A file on a message's way, and what happens there."""

    file: str
    what: str


def steps(walk: str, page_name: str = "architecture.md") -> list[Step]:
    """The numbered list after a line of a page. SystemExit if one of its files does not exist."""
    page = (DOCS / page_name).read_text(encoding="utf-8").partition(walk)[2]
    listed = re.search(r"(?:^\d+\. .*\n)+", page, re.MULTILINE)
    found = re.findall(r"^\d+\. `([^`]+)`:? (.*)$", listed[0] if listed else "", re.MULTILINE)
    places = (TOOLKIT, ROOT / "codegen/underlay", ROOT)
    if missing := [file for file, _ in found if not any((place / file).is_file() for place in places)]:
        raise SystemExit(f"{page_name} names what does not exist: {', '.join(missing)}")
    if not found:
        raise SystemExit(f"{page_name} has no list after {walk!r}")
    return [Step(file, re.sub(r" \(at the top.*|`", "", what)) for file, what in found]


def _room_of(step: Step) -> str:
    return step.file.rpartition("/")[0].removeprefix("codegen/")


class Column:
    """Rooms with their files, one below the other."""

    def __init__(self, left: float, width: float, title: str) -> None:
        self.parts = [_text(left + width / 2, 22, title, "name", "middle")]
        self.boxes: list[tuple[Box, Sequence[Step]]] = []
        self._left, self._width = left, width

    def add(self, steps: Sequence[Step], *, title: str = "", css: str = "") -> None:
        """A box for steps in one room, and the arrow that leads to it."""
        top = 44.0
        if self.boxes:
            above = self.boxes[-1][0]
            top = above.bottom + 22
            self.parts.append(f'<path d="M{above.middle:g} {above.bottom:g} V{top:g}"/>')
        box = Box(self._left, top, self._width, 26 + _STEP * len(steps))
        self.parts += [
            f'<g class="{css}">',
            _box(box),
            "</g>",
            _text(box.left + 12, top + 18, title, "small"),
        ]
        for index, step in enumerate(steps):
            at = top + 36 + _STEP * index
            what = textwrap.shorten(step.what, 66, placeholder=" ...")
            self.parts.append(_text(box.left + 12, at, step.file.rpartition("/")[2], "file"))
            self.parts.append(_text(box.left + 12, at + 15, what, "small"))
        self.boxes.append((box, steps))

    def add_rooms(self, steps: Sequence[Step]) -> None:
        """A box for each run of steps in one room."""
        for room, group in groupby(steps, _room_of):
            self.add(list(group), title=room)


def message() -> str:
    """The picture of a message's way: first what makes its class, then what carries it."""
    *generating, serialising = steps("The files on that way")
    carried = steps("And a message's way")
    width = (WIDTH - 3 * 20) / 2
    left, right = (
        Column(20, width, "ifgen generate: once"),
        Column(40 + width, width, "publish: each message"),
    )
    left.add_rooms(generating)
    if not (ROOT / "generated" / _CLASS).is_file():
        raise SystemExit(f"there is no generated/{_CLASS}")
    made = Step(_CLASS, "the class, and the functions that serialise it")
    left.add([made], title=f"generated/{_CLASS.rpartition('/')[0]}", css="bound")
    left.add_rooms([serialising])
    right.add_rooms(carried)
    right.add([Step("callback", "gets a message of its own")], title="your node", css="bound")
    start = left.boxes[-1][0]
    [end] = [box for box, held in right.boxes if any(step.file == "rmw_local/writer.py" for step in held)]
    edge, foot = start.left + start.width, start.top + start.height / 2
    way = f"M{edge:g} {foot:g} H{WIDTH / 2:g} V{end.top + 30:g} H{end.left:g}"
    height = max(left.boxes[-1][0].bottom, right.boxes[-1][0].bottom) + 14
    return _svg(height, "The way of one message", [*left.parts, *right.parts, f'<path d="{way}"/>'])


# What processes share, by the modules that use it, and who is on its other side.
_SHARED: Final = (
    ("memory.py", "/dev/shm/ifgen-<user>/", "a file, as large as needed", "another process"),
    ("doorbell.py", "/tmp/ifgen-<user>/<domain>/", "a socket to ring at", "another process"),
    ("engine.py", "/tmp/ifgen-<user>/<domain>/", "a socket of the session", "another process"),
    ("engine.py", "ifgen router", "tcp or tls, where you say so", "another machine"),
)


def processes() -> str:
    """The picture of what is between processes."""
    left = Column(20, 400, "a process")
    left.add_rooms(steps("From the program down", "processes.md"))
    at = {
        step.file.rpartition("/")[2]: box.top + 36 + _STEP * index
        for box, held in left.boxes
        for index, step in enumerate(held)
    }
    parts, height, width = list(left.parts), 44.0, 230.0
    sides: dict[str, list[Box]] = {}
    top = 0.0
    for module, name, what, side in _SHARED:
        top = max(at[module] - height / 2, top + height + 14)
        box = Box(475, top, width, height)
        parts += [_box(box), _text(box.left + 12, top + 19, name, "file")]
        parts += [_text(box.left + 12, top + 35, what, "small")]
        parts.append(f'<path d="M420 {at[module]:g} H448 V{top + height / 2:g} H{box.left:g}"/>')
        parts.append(f'<path d="M{WIDTH - 150:g} {top + height / 2:g} H{box.left + width:g}"/>')
        sides.setdefault(side, []).append(box)
    for side, boxes in sides.items():
        first = left.boxes[0][0].top if side == "another process" else boxes[0].top
        box = Box(WIDTH - 150, first, 130, boxes[-1].bottom - first)
        parts += ['<g class="bound">', _box(box), "</g>", _text(box.middle, first + 22, side, "", "middle")]
        who = "the same layers" if side == "another process" else "or rmw_zenoh"
        parts.append(_text(box.middle, first + 38, who, "small", "middle"))
    foot = max(left.boxes[-1][0].bottom, top + height) + 14
    return _svg(foot, "Between processes", parts)


def main(arguments: Sequence[str]) -> int:
    """Draw the pictures; with --check compare them only, and return 1 if they differ."""
    drawn = {"rooms.svg": rooms(), "message.svg": message(), "processes.svg": processes()}
    pictures = {DOCS / name: text for name, text in drawn.items()}
    if "--check" not in arguments:
        for path, text in pictures.items():
            path.write_text(text, encoding="utf-8")
        return 0
    stale = [
        p.name for p, text in pictures.items() if not p.is_file() or p.read_text(encoding="utf-8") != text
    ]
    if stale:
        print(f"{' and '.join(stale)} no longer show what there is: run `python docs/pictures.py`")
    return int(bool(stale))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
