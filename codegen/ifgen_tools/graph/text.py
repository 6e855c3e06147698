"""A graph as Mermaid and as DOT: nodes are boxes, topics rounded, services and actions hexagons.

Endpoints that can never match are joined in red. A connection with an empty side is dashed.
"""

from __future__ import annotations

from collections.abc import Iterator

from ifgen_tools.graph.connections import Connection, End, Graph


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
