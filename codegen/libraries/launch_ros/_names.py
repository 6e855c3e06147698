"""Names and namespaces of nodes."""

from __future__ import annotations

import re

_NAMESPACE = re.compile(r"/|(/[A-Za-z_][A-Za-z0-9_]*)+")
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def joined(outer: str | None, inner: str | None) -> str | None:
    """Return a namespace within another one; an absolute one stays as it is, and None stands for none."""
    if inner is None or outer is None:
        return outer if inner is None else inner
    if inner.startswith("/") or not outer:
        return inner
    return f"{outer.rstrip('/')}/{inner}" if inner else outer


def absolute(namespace: str) -> str:
    """Return a namespace with a `/` in front, and none at its end. Raises RuntimeError."""
    found = "/" + namespace.strip("/")
    if not _NAMESPACE.fullmatch(found):
        raise RuntimeError(
            f"'{namespace}' is no namespace: expected names of letters, digits and _, with / between them"
        )
    return found


def checked_name(name: str) -> str:
    """Return the name of a node. Raises RuntimeError."""
    if not _NAME.fullmatch(name):
        raise RuntimeError(f"'{name}' is no name of a node: expected letters, digits and _, no digit first")
    return name
