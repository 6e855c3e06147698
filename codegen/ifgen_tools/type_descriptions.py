"""Asks running nodes for the types of topics, services and actions.

`ifgen.dynamic` offers these functions, too.

A node describes a type to whoever knows its hash. The hash of a service is in the graph of our transport, but
not in that of DDS, which has those of the request and the response only, and by these no node of a real ROS
describes anything. It describes the events of a service, where its introspection is switched on.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from typing import Any, Final, TypeVar

from ifgen.definition.described.reading import ACTION_PARTS, SERVICE_PARTS, read
from ifgen.definition.type_description import TypeId, type_hash
from ifgen.dynamic import DescribeError, TypeDescription
from ifgen_runtime.mismatch.type_description_client import (
    Connection,
    Inquiry,
    Patience,
    Question,
    definition_from,
    node_connection,
)

_POLL: Final = 0.05
"""Seconds between two looks at the graph."""

_NAMING: Final = 2.0
"""Seconds until the middleware has told which nodes are on a topic."""

_VALID: Final = "RIHS01_"
_UNKNOWN: Final = "_NODE_NAME_UNKNOWN_"
_EVENTS: Final = "/_service_event"
_EVENT: Final = "_Event"

FoundT = TypeVar("FoundT")


def describe(node: Any, topic: str, *, timeout: float = 5.0, type_hash: str | None = None) -> TypeDescription:
    """The type of a topic, from a node that publishes it, or from one that subscribes to it.

    `node` is any node of rclpy, real or ours, whether it spins or not. `topic` is expanded and remapped as
    that node does it. With `type_hash`, only a type with that hash will do: a topic may have several
    versions. Waits up to `timeout` [s] for somebody on the topic and for answers. Call it where waiting is
    allowed: if the node that knows the type spins in this thread only, it cannot answer meanwhile.

    Raises DescribeError if nobody is there, or nobody answers.
    """

    def named() -> list[Question]:
        return [question for question in endpoints_of(node, topic, type_hash) if _is_named(question)]

    with _conversation(node, timeout) as conversation:
        endpoints = conversation.wait_for(lambda: endpoints_of(node, topic, type_hash))
        if not endpoints:
            raise DescribeError(_nobody(node, topic, timeout, type_hash))
        endpoints = conversation.wait_for(named, _NAMING) or endpoints
        return conversation.first_answer(endpoints, f"'{topic}'")


def describe_service(node: Any, service: str, *, timeout: float = 5.0) -> TypeDescription:
    """The type of a service, from a node that serves it.

    `node`, `timeout` [s] and waiting are as for `describe`. On real rclpy a node can tell only while the
    introspection of the service is switched on, at the server or at a client.

    Raises DescribeError if nobody serves it, or nobody describes it.
    """
    with _conversation(node, timeout) as conversation:
        return _service(conversation, node, node.resolve_service_name(service), f"service '{service}'")


def describe_action(node: Any, action: str, *, timeout: float = 5.0) -> TypeDescription:
    """The type of an action, from a node that serves it: on our transport only.

    `node`, `timeout` [s] and waiting are as for `describe`. Raises DescribeError if nobody serves it, or
    nobody describes it.
    """
    what = f"action '{action}'"
    name = node.resolve_topic_name(action)
    with _conversation(node, timeout) as conversation:
        parts = [
            _service(conversation, node, f"{name}/_action/{part}", what)
            for part in ("send_goal", "get_result")
        ]
        feedback = endpoints_of(node, f"{name}/_action/feedback")
        parts.append(conversation.first_answer(feedback, f"the {what}"))
    whole = parts[0].type_name.removesuffix("_SendGoal")
    return _composed(whole, ACTION_PARTS, parts)


def answers(node: Any, questions: Iterable[Question], timeout: float) -> dict[Question, TypeDescription]:
    """The answers of other nodes about types that they use. All are asked together, each once.

    Nodes that do not answer within `timeout` [s], or refuse, are left out.
    """
    found: dict[Question, TypeDescription] = {}
    with _conversation(node, timeout) as conversation:
        for question, response in conversation.inquiry(questions).responses(Patience(timeout, timeout)):
            answer = _answer(question, response)
            if isinstance(answer, TypeDescription):
                found[question] = answer
    return found


def endpoints_of(node: Any, topic: str, type_hash: str | None = None) -> list[Question]:
    """The endpoints of a topic, one for each node and type; publishers come first."""
    infos = (*node.get_publishers_info_by_topic(topic), *node.get_subscriptions_info_by_topic(topic))
    found: dict[Question, None] = {}
    for info in infos:
        name = f"{info.node_namespace.rstrip('/')}/{info.node_name}"
        question = Question(name, info.topic_type, str(info.topic_type_hash))
        if type_hash in {None, question.type_hash}:
            found[question] = None
    return list(found)


def servers_of(node: Any, name: str) -> list[Question] | None:
    """The servers of a service with its hash; None on a real rclpy, which does not tell."""
    if find_spec("rmw_local") is None:
        return None
    from rclpy.impl.rcl.graph import service_types  # of our transport only

    with node.handle:
        found = service_types(node.handle, name)
    return [Question(*server) for server in dict.fromkeys(found)]


@contextmanager
def _conversation(node: Any, timeout: float) -> Generator[_Conversation]:
    with node_connection(node.context, "_ifgen_describe", _POLL) as connection:
        yield _Conversation(connection, timeout)


class _Conversation:
    """Asks until its time is over."""

    def __init__(self, connection: Connection, timeout: float) -> None:
        self.timeout = timeout
        self._connection = connection
        self._until = connection.now() + timeout

    def wait_for(self, look: Callable[[], list[FoundT]], patience: float | None = None) -> list[FoundT]:
        """The first result that is not empty; an empty one if there is none in time, or in `patience` [s]."""
        until = self._until
        if patience is not None:
            until = min(until, self._connection.now() + patience)
        while not (found := look()) and (left := until - self._connection.now()) > 0:
            self._connection.wait(left)
        return found

    def inquiry(self, questions: Iterable[Question]) -> Inquiry:
        """The questions that make sense, asked together."""
        return Inquiry(self._connection, [question for question in questions if not _unaskable(question)])

    def first_answer(self, questions: Sequence[Question], what: str) -> TypeDescription:
        """The first answer. Raises DescribeError, with the reasons why there is none."""
        reasons = {question: _unaskable(question) for question in questions}
        inquiry = self.inquiry(questions)
        left = self._until - self._connection.now()
        for question, response in inquiry.responses(Patience(left, left)):
            answer = _answer(question, response)
            if isinstance(answer, TypeDescription):
                return answer
            reasons[question] = answer
        for question in inquiry.unsent:
            reasons[question] = f"{question.node} has no service ~/get_type_description"
        for question in inquiry.unanswered:
            reasons[question] = f"{question.node} has not answered within {self.timeout:g} s: is it spinning?"
        text = "; ".join(dict.fromkeys(reasons.values())) or "nobody serves it"
        raise DescribeError(f"nobody describes the type of {what}: {text}")


def _answer(question: Question, response: Any) -> TypeDescription | str:
    if response is None:
        return f"{question.node} has gone before it answered"
    try:
        definition = definition_from(response)
    except ValueError as error:
        return f"{question.node} says: {error}"
    return TypeDescription(
        type_name=question.type_name,
        type_hash=question.type_hash,
        document=definition.document,
        node=question.node,
        sources=definition.sources,
    )


def _unaskable(question: Question) -> str:
    """The reason why a question makes no sense; empty if it does."""
    if not _is_named(question):
        return "the middleware does not say which node it is"
    if not question.type_hash.startswith(_VALID):
        return f"{question.node} does not say which hash its type has, as ROS 2 before Iron"
    return ""


def _is_named(question: Question) -> bool:
    """False while the middleware does not know which node it is: DDS tells that a moment later."""
    return _UNKNOWN not in question.node


def _nobody(node: Any, topic: str, timeout: float, type_hash: str | None) -> str:
    if type_hash is not None and (others := endpoints_of(node, topic)):
        known = ", ".join(dict.fromkeys(endpoint.type_hash for endpoint in others))
        return f"nobody on '{topic}' has the type {type_hash}: they have {known}"
    return f"nobody has published or subscribed to '{topic}' within {timeout:g} s"


def _service(conversation: _Conversation, node: Any, name: str, what: str) -> TypeDescription:
    if not conversation.wait_for(lambda: _types(node, name)):
        raise DescribeError(f"nobody has served the {what} within {conversation.timeout:g} s")
    servers = servers_of(node, name)
    if servers is not None:
        return conversation.first_answer(servers, f"the {what}")
    events = [each for each in endpoints_of(node, name + _EVENTS) if each.type_name.endswith(_EVENT)]
    if not events:
        raise DescribeError(
            f"nobody can describe the type of the {what}: nodes of a real ROS know it by a hash that "
            "DDS does not tell, and nobody publishes events about it (service introspection)"
        )
    event = conversation.first_answer(events, f"the {what}")
    return _composed(event.type_name.removesuffix(_EVENT), SERVICE_PARTS, [event])


def _types(node: Any, name: str) -> list[str]:
    return [type_ for known, types in node.get_service_names_and_types() if known == name for type_ in types]


def _composed(
    type_name: str, suffixes: Mapping[str, str], parts: Sequence[TypeDescription]
) -> TypeDescription:
    """The description of a service or an action, all of whose parts are described by others."""
    types: dict[str, Any] = {}
    sources: dict[str, tuple[str, str, str]] = {}
    for part in parts:
        described = [part.document["type_description"], *part.document["referenced_type_descriptions"]]
        types.update((each["type_name"], each) for each in described)
        sources.update((source[0], source) for source in part.sources)
    fields = [_field(name, type_name + suffix) for name, suffix in suffixes.items()]
    document = {
        "type_description": {"type_name": type_name, "fields": fields},
        "referenced_type_descriptions": [types[name] for name in sorted(types)],
    }
    found = type_hash(*read(document))
    return TypeDescription(type_name, found, document, parts[0].node, tuple(sources.values()))


def _field(name: str, type_name: str) -> dict[str, Any]:
    type_ = {
        "type_id": int(TypeId.NESTED),
        "capacity": 0,
        "string_capacity": 0,
        "nested_type_name": type_name,
    }
    return {"name": name, "type": type_, "default_value": ""}
