"""The policy.xml of SROS 2 (version 0.2.0), and whether a text is one, as its schema has it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from typing import Final
from xml.etree import ElementTree

from ifgen.nodl.model import Category

from ifgen_tools.policy.grants import Grant, Grants

VERSION: Final = "0.2.0"
_LISTS: Final = {
    Category.PUBLISHER: ("topics", "publish", "topic"),
    Category.SUBSCRIPTION: ("topics", "subscribe", "topic"),
    Category.SERVICE_SERVER: ("services", "reply", "service"),
    Category.SERVICE_CLIENT: ("services", "request", "service"),
    Category.ACTION_SERVER: ("actions", "execute", "action"),
    Category.ACTION_CLIENT: ("actions", "call", "action"),
}
"""For each category the list, the attribute of the list, and the elements in it."""

_XML: Final = "{http://www.w3.org/XML/1998/namespace}base"
_CHILDREN: Final = {
    "policy": ("enclaves",),
    "enclaves": ("enclave",),
    "enclave": ("profiles",),
    "profiles": ("profile", "metadata"),
    "profile": ("topics", "services", "actions"),
    "topics": ("topic",),
    "services": ("service",),
    "actions": ("action",),
}
_ATTRIBUTES: Final = {
    "policy": ({"version"}, set[str]()),
    "enclave": ({"path"}, set[str]()),
    "profiles": (set[str](), {"type"}),
    "profile": ({"ns", "node"}, {_XML}),
    "topics": (set[str](), {"publish", "subscribe", _XML}),
    "services": (set[str](), {"reply", "request", _XML}),
    "actions": (set[str](), {"call", "execute", _XML}),
}
"""The attributes that an element must have, and those that it may."""
_EMPTY: Final = frozenset({"profile"})
"""Elements that need nothing in them."""
_VERBS: Final = frozenset(attribute for _, attribute, _ in _LISTS.values())
_QUALIFIERS: Final = ("ALLOW", "DENY")


def text(grants: Iterable[Grants]) -> str:
    """The policy.xml with one enclave for each identity."""
    policy = ElementTree.Element("policy", version=VERSION)
    enclaves = ElementTree.SubElement(policy, "enclaves")
    ordered = sorted(grants, key=lambda each: (each.enclave, each.node))
    for path, nodes in groupby(ordered, key=lambda each: each.enclave):
        enclave = ElementTree.SubElement(enclaves, "enclave", path=path)
        profiles = ElementTree.SubElement(enclave, "profiles")
        for each in nodes:
            namespace, _, name = each.node.rpartition("/")
            profile = ElementTree.SubElement(profiles, "profile", ns=namespace or "/", node=name)
            _fill(profile, each.grants)
    ElementTree.indent(policy)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ElementTree.tostring(policy, encoding="unicode")}\n'


def _fill(profile: ElementTree.Element, grants: Sequence[Grant]) -> None:
    for category, (list_, attribute, item) in _LISTS.items():
        names = sorted({each.name for each in grants if each.category is category})
        if names:
            parent = ElementTree.SubElement(profile, list_, {attribute: "ALLOW"})
            for name in names:
                ElementTree.SubElement(parent, item).text = name


def problems(policy: str) -> list[str]:
    """All that the schema of SROS 2 would refuse in a text; nothing if it is a policy."""
    try:
        root = ElementTree.fromstring(policy)
    except ElementTree.ParseError as error:
        return [f"this is no XML: {error}"]
    if root.tag != "policy":
        return [f"`{root.tag}` is no policy"]
    return list(_problems(root))


def _problems(element: ElementTree.Element) -> Iterator[str]:
    if element.tag == "metadata":  # anything
        return
    tag = element.tag
    required, optional = _ATTRIBUTES.get(tag, (set(), set()))
    for name in sorted(required - element.attrib.keys()):
        yield f"`{tag}` needs the attribute `{name}`"
    for name, value in element.attrib.items():
        if name not in required | optional:
            yield f"`{tag}` has no attribute `{name}`"
        elif name in _VERBS and value not in _QUALIFIERS:
            yield f"`{name}` of `{tag}` must be ALLOW or DENY, not `{value}`"
    known = _CHILDREN.get(tag)
    if known is None:
        if len(element) or not (element.text or "").strip():
            yield f"`{tag}` must have a name as its text"
        return
    if not len(element) and tag not in _EMPTY:
        yield f"`{tag}` must not be empty"
    for child in element:
        if child.tag in known:
            yield from _problems(child)
        else:
            yield f"`{child.tag}` does not belong into `{tag}`"
