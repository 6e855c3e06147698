"""A graph as Mermaid, as DOT and as SVG, which needs no other program to be made or shown.

Nodes are boxes, topics rounded, services and actions hexagons. Endpoints that can never match are joined in
red. A connection with an empty side is dashed.
"""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from itertools import pairwise

from ifgen_tools.graph.connections import Connection, End, Graph
from ifgen_tools.graph.layout import Edge, Layout, layout


def mermaid(graph: Graph) -> str:
    """The graph as a Mermaid flowchart, which GitHub and most Markdown viewers draw."""
    return "\n".join(_mermaid(graph)) + "\n"


def dot(graph: Graph) -> str:
    """The graph in the language of Graphviz."""
    return "\n".join(_dot(graph)) + "\n"


def _mermaid(graph: Graph) -> Iterator[str]:
    shapes = {"topic": ('(["', '"])'), "service": ('{{"', '"}}'), "action": ('[["', '"]]')}
    yield "flowchart LR"
    names = {node: f"n{index}" for index, node in enumerate(graph.nodes)}
    for node, identifier in names.items():
        yield f'    {identifier}["{_entities(node)}"]'
    red: list[int] = []
    edges = 0
    for index, connection in enumerate(graph.connections):
        opening, closing = shapes[connection.kind]
        label = "<br>".join(map(_entities, label_lines(connection)))
        yield f"    c{index}{opening}{label}{closing}"
        if connection.missing:
            yield f"    class c{index} open"
        for end, is_source in _ends(connection):
            arrow = "-.->" if connection.missing else "-->"
            pair = (names[end.node], f"c{index}")
            source, target = pair if is_source else pair[::-1]
            yield f"    {source} {arrow} {target}"
            if end.problem:
                red.append(edges)
            edges += 1
    yield "    classDef open stroke-dasharray: 4 3"
    if red:
        yield f"    linkStyle {','.join(map(str, red))} stroke:#c00,stroke-width:3px"
    for problem in graph.problems:
        yield f"    %% {problem}"


def _dot(graph: Graph) -> Iterator[str]:
    shapes = {"topic": "ellipse", "service": "hexagon", "action": "doubleoctagon"}
    yield "digraph nodes {"
    yield "    rankdir=LR;"
    yield '    node [fontname="sans-serif", fontsize=11];'
    for node in graph.nodes:
        yield f"    {_quoted(node)} [shape=box, style=filled, fillcolor=lightblue];"
    for connection in graph.connections:
        identifier = _quoted(f"{connection.kind} {connection.name}")
        label = "\\n".join(_quoted(line)[1:-1] for line in label_lines(connection))
        style = ", style=dashed" if connection.missing else ""
        yield f'    {identifier} [shape={shapes[connection.kind]}, label="{label}"{style}];'
        for end, is_source in _ends(connection):
            pair = (_quoted(end.node), identifier)
            source, target = pair if is_source else pair[::-1]
            attributes = [] if not connection.missing else ["style=dashed"]
            if end.problem:
                attributes += ["color=red", "penwidth=2", f"tooltip={_quoted(end.problem)}"]
            suffix = f" [{', '.join(attributes)}]" if attributes else ""
            yield f"    {source} -> {target}{suffix};"
    for problem in graph.problems:
        yield f"    // {problem}"
    yield "}"


def label_lines(connection: Connection) -> tuple[str, ...]:
    """The lines in the box of a connection: its name, its types, and the empty side."""
    missing = (connection.missing,) if connection.missing else ()
    return (connection.name, *connection.type_names, *missing)


def _ends(connection: Connection) -> Iterator[tuple[End, bool]]:
    yield from ((end, True) for end in connection.sources)
    yield from ((end, False) for end in connection.targets)


def _entities(text: str) -> str:
    for character, entity in (("&", "&amp;"), ("<", "&lt;"), (">", "&gt;"), ('"', "&quot;")):
        text = text.replace(character, entity)
    return text


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


_LINE = 15.0
_CHARACTER = 6.7
_MARGIN = 16.0
_STYLE = """
  svg { font: 12px ui-sans-serif, system-ui, sans-serif; background: white }
  text { text-anchor: middle; dominant-baseline: middle; fill: #1c2733 }
  .type { fill: #5b6b7b; font-size: 11px }
  .missing { fill: #a15c00; font-size: 11px; font-style: italic }
  .node rect { fill: #d9e8f6; stroke: #3b6ea5; stroke-width: 1.5 }
  .topic rect { fill: #f6f7f8; stroke: #8a97a5 }
  .service rect { fill: #e5f4e8; stroke: #4c9a5f }
  .action rect { fill: #f8ecd9; stroke: #c08a2d }
  .open rect { stroke-dasharray: 4 3 }
  path { fill: none; stroke: #8a97a5; stroke-width: 1.3; marker-end: url(#arrow) }
  path.open { stroke-dasharray: 4 3 }
  path.never { stroke: #c00; stroke-width: 2.5; marker-end: url(#red) }
"""


def svg(graph: Graph) -> str:
    """The picture. What can never meet is red, with the reason as a tooltip and at the foot."""
    return "\n".join(_svg(graph)) + "\n"


def _svg(graph: Graph) -> Iterator[str]:
    labels = {node: (node,) for node in graph.nodes} | {_key(c): label_lines(c) for c in graph.connections}
    sizes = {
        key: (max(map(len, lines)) * _CHARACTER + 20, len(lines) * _LINE + 10)
        for key, lines in labels.items()
    }
    edges = {edge: None for connection in graph.connections for edge in _edges(connection)}
    placed = layout(sizes, list(edges))
    foot = len(graph.problems) * _LINE
    width, height = placed.width + 2 * _MARGIN, placed.height + 2 * _MARGIN + foot
    if graph.problems:
        width = max(width, max(map(len, graph.problems)) * _CHARACTER + 2 * _MARGIN)
    box = f"{-_MARGIN:g} {-_MARGIN:g} {width:.0f} {height:.0f}"
    yield '<svg xmlns="http://www.w3.org/2000/svg"'
    yield f'     viewBox="{box}" width="{width:.0f}" height="{height:.0f}">'
    yield f"<style>{_STYLE}</style>"
    yield f"<defs>{_arrow('arrow', '#8a97a5')}{_arrow('red', '#c00')}</defs>"
    for connection in graph.connections:
        yield from _paths(connection, placed, sizes)
    for node in graph.nodes:
        yield from _box("node", (node,), placed.centres[node], sizes[node], 3)
    for connection in graph.connections:
        key = _key(connection)
        css = f"{connection.kind} open" if connection.missing else connection.kind
        radius = sizes[key][1] / 2 if connection.kind == "topic" else 8
        yield from _box(css, labels[key], placed.centres[key], sizes[key], radius)
    for index, problem in enumerate(graph.problems):
        y = placed.height + _MARGIN / 2 + (index + 0.5) * _LINE
        yield f'<text x="0" y="{y:.1f}" style="text-anchor: start; fill: #c00">{escape(problem)}</text>'
    yield "</svg>"


def _key(connection: Connection) -> str:
    return f"{connection.kind} {connection.name}"


def _edges(connection: Connection) -> Iterator[Edge]:
    yield from ((end.node, _key(connection)) for end in connection.sources)
    yield from ((_key(connection), end.node) for end in connection.targets)


def _paths(connection: Connection, placed: Layout, sizes: dict[str, tuple[float, float]]) -> Iterator[str]:
    ends = (*connection.sources, *connection.targets)
    for edge, end in zip(_edges(connection), ends, strict=True):
        css = "never" if end.problem else "open" if connection.missing else ""
        title = f"<title>{escape(end.problem)}</title>" if end.problem else ""
        yield f'<path class="{css}" d="{_curve(edge, placed, sizes)}">{title}</path>'


def _curve(edge: Edge, placed: Layout, sizes: dict[str, tuple[float, float]]) -> str:
    source, target = edge
    (x1, y1), (x2, y2) = placed.centres[source], placed.centres[target]
    side = 1 if x2 >= x1 else -1
    points = [
        (x1 + side * sizes[source][0] / 2, y1),
        *placed.bends[edge],
        (x2 - side * (sizes[target][0] / 2 + 2), y2),
    ]
    parts = [f"M{points[0][0]:.1f},{points[0][1]:.1f}"]
    for (ax, ay), (bx, by) in pairwise(points):
        middle = (ax + bx) / 2
        parts.append(f"C{middle:.1f},{ay:.1f} {middle:.1f},{by:.1f} {bx:.1f},{by:.1f}")
    return " ".join(parts)


def _box(
    css: str, lines: tuple[str, ...], centre: tuple[float, float], size: tuple[float, float], radius: float
) -> Iterator[str]:
    (x, y), (width, height) = centre, size
    yield f'<g class="{css}">'
    yield (
        f'<rect x="{x - width / 2:.1f}" y="{y - height / 2:.1f}" width="{width:.1f}" height="{height:.1f}"'
        f' rx="{radius:g}"/>'
    )
    for index, line in enumerate(lines):
        kind = "" if index == 0 else "missing" if line.startswith("no ") else "type"
        top = y + (index - (len(lines) - 1) / 2) * _LINE
        yield f'<text class="{kind}" x="{x:.1f}" y="{top:.1f}">{escape(line)}</text>'
    yield "</g>"


def _arrow(name: str, colour: str) -> str:
    return (
        f'<marker id="{name}" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7"'
        f' orient="auto" markerUnits="userSpaceOnUse"><path d="M0,0 L8,4 L0,8 z"'
        f' style="fill: {colour}; stroke: none; marker-end: none"/></marker>'
    )
