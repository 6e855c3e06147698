"""Access control of Zenoh: for a router that knows its clients, and for the session of a node itself.

Data has the keys of rmw_zenoh and of our transport, `<domain>/<name>/<type>/<hash>`; what late subscriptions
ask for lies below, in `@adv`. A router sees what a client sends as `ingress`; the client itself as `egress`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby
from typing import Any, Final, Literal, TypeAlias

from ifgen.nodl.model import Category

from ifgen_tools.policy.grants import Grant, Grants

Flow: TypeAlias = Literal["ingress", "egress"]
Identity: TypeAlias = Literal["certificates", "users"]

_OTHER: Final[dict[Flow, Flow]] = {"ingress": "egress", "egress": "ingress"}
_KINDS: Final = {
    Category.PUBLISHER: "MP",
    Category.SUBSCRIPTION: "MS",
    Category.SERVICE_SERVER: "SS",
    Category.SERVICE_CLIENT: "SC",
}
_LIVELINESS: Final = ("liveliness_token", "liveliness_query", "declare_liveliness_subscriber", "reply")


@dataclass(frozen=True, slots=True)
class Rule:
    """Messages with these keys that may pass: `sent` by the node, or sent to it."""

    messages: tuple[str, ...]
    keys: tuple[str, ...]
    sent: bool


def data_key(grant: Grant, domain: int) -> str:
    """The key of a topic or a service; a definition that nobody knows may be any."""
    package, folder, name = grant.type_name.split("/")
    return f"{domain}/{grant.name.strip('/')}/{package}::{folder}::dds_::{name}_/{grant.type_hash or '*'}"


def router(grants: Iterable[Grants], domain: int, identity: Identity) -> dict[str, Any]:
    """The configuration of a router at which only these nodes meet, each within its rights."""
    by_enclave = _by_enclave(grants)
    key = {"certificates": "cert_common_names", "users": "usernames"}[identity]
    subjects = [{"id": enclave, key: [enclave]} for enclave in by_enclave]
    rules: list[dict[str, Any]] = []
    policies = []
    for enclave, nodes in by_enclave.items():
        own = [_written(f"{enclave} {n}", each, "ingress") for n, each in enumerate(_rules(nodes, domain))]
        rules += own
        policies.append({"rules": [each["id"] for each in own], "subjects": [enclave]})
    return {"mode": "router", "access_control": _control(rules, subjects, policies)}


def session(nodes: list[Grants], domain: int) -> dict[str, Any]:
    """The configuration of the session of a process with these nodes, which holds back all else itself."""
    rules = [_written(f"{n}", each, "egress") for n, each in enumerate(_rules(nodes, domain))]
    policies = [{"rules": [each["id"] for each in rules], "subjects": ["everybody"]}]
    return {"access_control": _control(rules, [{"id": "everybody"}], policies)}


def sessions(grants: Iterable[Grants], domain: int) -> dict[str, dict[str, Any]]:
    """The configuration of each session, by enclave."""
    return {enclave: session(nodes, domain) for enclave, nodes in _by_enclave(grants).items()}


def _by_enclave(grants: Iterable[Grants]) -> dict[str, list[Grants]]:
    ordered = sorted(grants, key=lambda each: (each.enclave, each.node))
    return {enclave: list(nodes) for enclave, nodes in groupby(ordered, key=lambda each: each.enclave)}


def _control(
    rules: list[dict[str, Any]], subjects: list[dict[str, Any]], policies: list[dict[str, Any]]
) -> dict[str, Any]:
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": subjects,
        "policies": policies,
    }


def _written(name: str, rule: Rule, sent: Flow) -> dict[str, Any]:
    return {
        "id": name,
        "permission": "allow",
        "flows": [sent if rule.sent else _OTHER[sent]],
        "messages": list(rule.messages),
        "key_exprs": list(rule.keys),
    }


def _rules(nodes: Iterable[Grants], domain: int) -> Iterator[Rule]:
    """The messages that the nodes of a process may send, and those that may be sent to them."""
    parts = [part for node in nodes for part in node.parts]

    def keys(*categories: Category, kept: bool = False) -> tuple[str, ...]:
        found = (each for each in parts if each.category in categories and (each.is_kept or not kept))
        return tuple(dict.fromkeys(data_key(each, domain) for each in found))

    def further(*categories: Category) -> tuple[str, ...]:
        return tuple(f"{key}/@adv/**" for key in keys(*categories, kept=True))

    published, heard = keys(Category.PUBLISHER), keys(Category.SUBSCRIPTION)
    served, called = keys(Category.SERVICE_SERVER), keys(Category.SERVICE_CLIENT)
    kept, missed = further(Category.PUBLISHER), further(Category.SUBSCRIPTION)
    kept_data = keys(Category.PUBLISHER, kept=True)
    missed_data = keys(Category.SUBSCRIPTION, kept=True)
    ours = tuple(f"@ifgen_{name}/{domain}/*" for name in ("alive", "receipts", "statistics"))
    all_tokens = (f"@ros2_lv/{domain}/**", f"@ifgen_lv/{domain}/**", f"@ifgen_settled/{domain}/*")
    own_tokens = tuple(dict.fromkeys(token for node in nodes for token in _tokens(node, domain)))
    rules = (
        Rule(("put", "delete"), published, sent=True),
        Rule(("declare_subscriber",), published, sent=False),
        Rule(("put", "delete"), heard, sent=False),
        Rule(("declare_subscriber",), heard, sent=True),
        Rule(("query",), called, sent=True),
        Rule(("declare_queryable", "reply"), called, sent=False),
        Rule(("query",), served, sent=False),
        Rule(("declare_queryable", "reply"), served, sent=True),
        # Messages that were published before a subscription came, and who keeps them.
        Rule(("declare_queryable", "reply", "put"), (*kept, *kept_data), sent=True),
        Rule(("query", "declare_subscriber"), (*kept, *kept_data), sent=False),
        Rule(("query", "declare_subscriber"), (*missed, *missed_data), sent=True),
        Rule(("declare_queryable", "reply", "put"), (*missed, *missed_data), sent=False),
        Rule(_LIVELINESS, (*kept, *missed), sent=True),
        Rule(_LIVELINESS, (*kept, *missed), sent=False),
        # The graph: each tells of itself, and all may look.
        Rule(("liveliness_token",), (*own_tokens, f"@ifgen_settled/{domain}/*"), sent=True),
        Rule(_LIVELINESS[1:], all_tokens, sent=True),
        Rule(_LIVELINESS, all_tokens, sent=False),
        # Whether publishers are alive, what has come, and statistics: keys of our transport.
        *(
            Rule(("put", "declare_subscriber", "query", "declare_queryable", "reply"), ours, sent=sent)
            for sent in (True, False)
        ),
    )
    return (rule for rule in rules if rule.keys)


def _tokens(node: Grants, domain: int) -> Iterator[str]:
    """The tokens by which a node and its endpoints appear in the graph, in whatever session."""
    namespace, _, name = node.node.rpartition("/")
    place = f"*/{_mangled(namespace or '/')}/{name}"  # in any enclave: the identity is that of the link
    yield f"@ros2_lv/{domain}/*/*/*/NN/{place}"
    for part in node.parts:
        _, type_, hash_ = data_key(part, domain).rsplit("/", 2)
        end = f"{_mangled(part.name)}/{type_}/{hash_}"
        yield f"@ros2_lv/{domain}/*/*/*/{_KINDS[part.category]}/{place}/{end}/**"


def _mangled(name: str) -> str:
    return name.replace("/", "%")
