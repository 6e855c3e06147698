"""Runs a program, looks at its only node, and keeps what was seen: `observe.py TRANSPORT PROGRAM FILE`."""

from __future__ import annotations

import pickle
import sys
from pathlib import Path

from ifgen_tools.beside import session_beside
from ifgen_tools.nodl import contract

transport, program, file = sys.argv[1:]
with session_beside([[program]], transport) as session:  # type: ignore[arg-type]
    [node] = session.graph().visible().nodes
    side = contract.seen(session, node)
Path(file).write_bytes(pickle.dumps(side))
