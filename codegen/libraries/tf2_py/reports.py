"""The frames of a buffer as texts: YAML, and graphs for Graphviz."""

from __future__ import annotations

from tf2_py.caches import Cache, seconds
from tf2_py.tree import FrameTree

# What a rate is worked out with if all transforms are of one time [ns].
_SHORTEST_SPAN = 100_000


def as_yaml(tree: FrameTree) -> str:
    """Return each frame with its parent, who sends it, and how often: a document in YAML."""
    if not tree.frames:
        return "[]"
    parts: list[str] = []
    for name, cache in tree.frames.items():
        edge = None if cache is None else cache.newest_edge
        if cache is None or edge is None:
            continue
        parts.append(
            f"{name}: \n"
            f"  parent: '{edge[0]}'\n"
            f"  broadcaster: '{_authority(tree, name)}'\n"
            f"  rate: {_rate(cache):.3f}\n"
            f"  most_recent_transform: {seconds(cache.latest)}\n"
            f"  oldest_transform: {seconds(cache.oldest)}\n"
            f"  buffer_length: {_span(cache):.3f}\n"
        )
    return "".join(parts)


def as_dot(tree: FrameTree, now: int) -> str:
    """Return the tree as a graph of Graphviz, with ages if the time `now` [ns] is not 0."""
    lines = ["digraph G {\n"]
    if not tree.frames:
        lines.append('"no tf data recieved"')
    for name, cache in tree.frames.items():
        edge = None if cache is None else cache.newest_edge
        if cache is None or edge is None:
            continue
        age = f"( {(now - cache.latest) * 1e-9:.3f} sec old)" if now else ""
        lines.append(
            f'"{edge[0]}" -> "{name}"[label="Broadcaster: {_authority(tree, name)}\\n'
            f"Average rate: {_rate(cache):.3f} Hz\\n"
            f"Most recent transform: {seconds(cache.latest)} {age}\\n"
            f'Buffer length: {_span(cache):.3f} sec\\n"];\n'
        )
    recorded = f'"Recorded at time: {seconds(now)}"[ shape=plaintext ] ;\n ' if now else ""
    for name, cache in tree.frames.items():
        is_root = cache is None and now != 0
        if is_root or (cache is not None and cache.newest_edge is None):
            lines.append(
                "edge [style=invis];\n"
                ' subgraph cluster_legend { style=bold; color=black; label ="view_frames Result";\n'
                f'{recorded}}}->"{name}";\n'
            )
    return "".join([*lines, "}"])


def _authority(tree: FrameTree, name: str) -> str:
    return tree.authorities.get(name, "no recorded authority")


def _rate(cache: Cache) -> float:
    """Transforms per second."""
    return len(cache) * 1e9 / max(cache.latest - cache.oldest, _SHORTEST_SPAN)


def _span(cache: Cache) -> float:
    """The time from the oldest to the latest, in seconds."""
    return (cache.latest - cache.oldest) * 1e-9
