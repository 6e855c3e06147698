"""The file in which `ifgen.observing.graph_observer` passes its observations to the command that runs it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ifgen.graph.model import SeenEndpoint
from ifgen.nodl.model import Category, QosProfile


def command(file: Path, nodes: int) -> list[str]:
    """The arguments that run the observer by `ifgen.running.run`; it waits for the given number of nodes."""
    return ["-m", "ifgen.observing.graph_observer", str(file), str(nodes)]


def write(file: Path, nodes: Sequence[str], seen: Sequence[SeenEndpoint]) -> None:
    """Write down nodes and endpoints."""
    document = {"nodes": nodes, "endpoints": [_plain(endpoint) for endpoint in seen]}
    file.write_text(json.dumps(document), encoding="utf-8")


def read(file: Path) -> tuple[tuple[str, ...], tuple[SeenEndpoint, ...]] | None:
    """The nodes and endpoints in the file; None if the observer ended before it wrote them."""
    if not file.is_file() or not file.stat().st_size:
        return None
    document = json.loads(file.read_text(encoding="utf-8"))
    return tuple(document["nodes"]), tuple(_endpoint(**each) for each in document["endpoints"])


def _plain(endpoint: SeenEndpoint) -> dict[str, Any]:
    values = asdict(endpoint)
    if endpoint.qos is not None:
        del values["qos"]["span"]
    return values


def _endpoint(
    node: str, name: str, category: str, type_name: str, qos: dict[str, Any] | None
) -> SeenEndpoint:
    return SeenEndpoint(node, name, Category(category), type_name, None if qos is None else QosProfile(**qos))
