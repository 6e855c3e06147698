"""The checks of each feature: what one side is told, and what the other must have received."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, Final, NamedTuple

from tests.interop.bench import samples
from tests.interop.bench.comparison import difference
from tests.interop.bench.exchange import Actor, Failed
from tests.interop.bench.outcomes import Feature
from tests.interop.bench.samples import Value

_MESSAGES: Final = 5
_LIMIT: Final = 15.0  # [s] for a message to arrive, or an answer
_TURN: Final = 0.2  # [s] between two tries
_QUIET: Final = 0.5  # [s] after which nothing more is expected
_APART: Final = 2.0  # [s] at most, between two pictures
_SIZES: Final = {"0.9 MB": (640, 480), "6.2 MB": (1920, 1080)}


class Task(NamedTuple):
    """A check with its name; it gets our side and the other one, and raises Failed or Lacking."""

    name: str
    run: Callable[[Actor, Actor], None]


def tasks(feature: Feature, types: Sequence[str], hashes: dict[str, str]) -> list[Task]:
    """The checks of a feature. `types` are those of the messages on topics."""
    match feature:
        case Feature.TOPIC:
            first = types[0]
            best_effort = partial(_topic, first, qos=samples.BEST_EFFORT)
            return [
                *(task for each in types for task in _both_ways(_short(each), partial(_topic, each))),
                *_both_ways(f"{_short(first)}, best effort", best_effort),
            ]
        case Feature.SERVICE:
            return [Task("their client", _service), Task("our client", _swapped(_service))]
        case Feature.ACTION:
            return [Task("their client", _action), Task("our client", _swapped(_action))]
        case Feature.PARAMETER:
            return [Task("ours", _parameters), Task("theirs", _swapped(_parameters))]
        case Feature.GRAPH:
            return [
                Task("we see them", partial(_graph, hashes)),
                Task("they see us", _swapped(partial(_graph, hashes))),
            ]
        case Feature.TRANSIENT_LOCAL:
            return [Task("to us", _kept), Task("from us", _swapped(_kept))]
        case Feature.IMAGE:
            return [
                task
                for size, (width, height) in _SIZES.items()
                for task in _both_ways(size, partial(_image, width, height))
            ]
        case Feature.BUFFERS:
            return [
                Task("a plain subscription of ours", partial(_buffers, [])),
                Task("beside one that takes buffers", partial(_buffers, ["cpu"])),
            ]


def _both_ways(name: str, run: Callable[..., None]) -> list[Task]:
    return [Task(f"{name} to us", run), Task(f"{name} from us", _swapped(run))]


def _swapped(run: Callable[..., None]) -> Callable[[Actor, Actor], None]:
    return lambda ours, theirs: run(theirs, ours)


# Each of these has first the one who receives or answers, then the other. Names differ for each direction, so
# that no check meets what another has left.


def _topic(type_name: str, receiver: Actor, sender: Actor, *, qos: Value = samples.QOS) -> None:
    topic = _name(_short(type_name), receiver, "reliable" if qos["reliable"] else "best_effort")
    messages = [samples.message(type_name, number) for number in range(_MESSAGES + 1)]
    receiver.do("subscribe", topic=topic, type=type_name, qos=qos)
    sender.do("publish", topic=topic, type=type_name, qos=qos)
    _deliver(topic, receiver, sender, messages)


def _image(width: int, height: int, receiver: Actor, sender: Actor) -> None:
    topic = _name(f"image_{height}", receiver)
    images = [samples.image(0, 4, 4), *(samples.image(number, width, height) for number in (1, 2))]
    receiver.do("subscribe", topic=topic, type=samples.IMAGE, qos=samples.QOS)
    sender.do("publish", topic=topic, type=samples.IMAGE, qos=samples.QOS)
    _deliver(topic, receiver, sender, images, _APART)


def _deliver(
    topic: str, receiver: Actor, sender: Actor, messages: Sequence[Value], apart: float = 0.0
) -> None:
    """Send the first message until it arrives, then the others: each must arrive once, and in order.

    Large ones are `apart` [s] at most: a publisher drops what its connection does not take.
    And the first one follows them, because dora-rs on DDS repairs a message when the next one comes.
    """
    first, *rest = messages
    send = partial(sender.do, "send", topic=topic)
    receive = partial(receiver.do, "received", topic=topic, count=1)
    end = time.monotonic() + _LIMIT
    came: list[Value] = []
    while not came:
        if time.monotonic() > end:
            raise Failed(f"no message within {_LIMIT:g} s")
        send(value=first)
        came = receive(seconds=_TURN)
    for message in rest:
        send(value=message)
        if apart:
            came += receive(seconds=apart)
    end = time.monotonic() + _LIMIT
    while sum(each != first for each in came) < len(rest) and time.monotonic() < end:
        if apart:
            send(value=first)
        came += receive(seconds=_TURN)
    came += receive(seconds=_QUIET)
    _compare([each for each in came if each != first], rest)


def _service(server: Actor, client: Actor) -> None:
    service = _name("service", server)
    response = {"success": True, "message": "Tür offen"}
    server.do("serve", service=service, type=samples.SET_BOOL, response=response)
    for request in ({"data": True}, {"data": False}):
        got = client.do("call", service=service, type=samples.SET_BOOL, request=request, seconds=_LIMIT)
        _compare(got, response)
        _compare(server.do("received", topic=service, count=1, seconds=_LIMIT), [request])


def _action(server: Actor, client: Actor) -> None:
    action = _name("action", server)
    feedback, result, goal = {"sequence": [0, 1]}, {"sequence": [0, 1, 1, 2]}, {"order": 3}
    server.do("serve_action", action=action, type=samples.FIBONACCI, feedback=feedback, result=result)
    got = client.do("act", action=action, type=samples.FIBONACCI, goal=goal, seconds=_LIMIT)
    _compare(got, {"status": "succeeded", "feedback": [feedback], "result": result})
    _compare(server.do("received", topic=action, count=1, seconds=_LIMIT), [goal])


def _parameters(owner: Actor, reader: Actor) -> None:
    """By the services that every node has: read, set, and read again."""
    owner.do("declare", name="stride", value=0.1)
    names: Any = {"names": ["stride"]}
    service = f"/{owner.node}/get_parameters"
    get = partial(reader.do, "call", service=service, type=samples.GET_PARAMETERS, seconds=_LIMIT)
    _compare(get(request=names), {"values": [_double(0.1)]})
    request = {"parameters": [{"name": "stride", "value": _double(-0.3)}]}
    service = f"/{owner.node}/set_parameters"
    done = reader.do("call", service=service, type=samples.SET_PARAMETERS, request=request, seconds=_LIMIT)
    _compare(done, {"results": [{"successful": True, "reason": ""}]})
    _compare(owner.do("parameter", name="stride"), -0.3)
    _compare(get(request=names), {"values": [_double(-0.3)]})


def _double(value: float) -> Value:
    empty: Value = {f"{kind}_array_value": [] for kind in ("bool", "integer", "double", "string")}
    plain = {"type": 3, "bool_value": False, "integer_value": 0, "double_value": value, "string_value": ""}
    return {**plain, **empty, "byte_array_value": []}


def _graph(hashes: dict[str, str], observer: Actor, seen: Actor) -> None:
    topic, service = _name("seen", observer), _name("seen_service", observer)
    node = seen.node
    seen.do("publish", topic=topic, type=samples.JOINT_STATE, qos=samples.QOS)
    seen.do("subscribe", topic=topic, type=samples.JOINT_STATE, qos=samples.BEST_EFFORT)
    seen.do("serve", service=service, type=samples.SET_BOOL, response={"success": True, "message": ""})

    def end(qos: Value) -> list[Value]:
        kind = {"node": node, "type": samples.JOINT_STATE, "hash": hashes[samples.JOINT_STATE]}
        return [{**kind, "qos": {key: qos[key] for key in ("reliable", "transient_local")}}]

    expected = {
        "publishers": end(samples.QOS),
        "subscriptions": end(samples.BEST_EFFORT),
        "services": [samples.SET_BOOL],
    }
    limit = time.monotonic() + _LIMIT
    while True:
        graph = observer.do("graph")
        found = {
            "publishers": graph["publishers"].get(topic),
            "subscriptions": graph["subscriptions"].get(topic),
            "services": graph["services"].get(service),
        }
        if found == expected and f"/{node}" in graph.get("nodes", [f"/{node}"]):
            return
        if time.monotonic() > limit:
            _compare(found, expected)
            raise Failed(f"the node {node} is not among {graph['nodes']}")
        time.sleep(_TURN)


def _kept(receiver: Actor, sender: Actor) -> None:
    """Five messages, then a subscription for the last three; then one more."""
    topic = _name("kept", receiver)
    messages = [samples.message(samples.STRING, number) for number in range(_MESSAGES + 1)]
    sender.do("publish", topic=topic, type=samples.STRING, qos=samples.KEPT)
    for message in messages[:_MESSAGES]:
        sender.do("send", topic=topic, value=message)
    receiver.do("subscribe", topic=topic, type=samples.STRING, qos=samples.KEPT)
    depth = samples.KEPT["depth"]
    got = receiver.do("received", topic=topic, count=depth, seconds=_LIMIT)
    _compare(got, messages[_MESSAGES - depth : _MESSAGES])
    sender.do("send", topic=topic, value=messages[-1])
    got = receiver.do("received", topic=topic, count=1, seconds=_LIMIT)
    _compare(got, messages[-1:])


def _buffers(others: Sequence[str], receiver: Actor, publisher: Actor) -> None:
    """A publisher that chooses keys as Lyrical does; without a subscription that it knows, it is silent."""
    topic = _name(f"buffer_{len(others)}", receiver)
    publisher.do("publish", topic=topic, type=samples.IMAGE, qos=samples.QOS)
    _compare(publisher.do("send", topic=topic, value=samples.image(0, 640, 480)), [])
    for backends in others:
        publisher.do("subscribe_with", topic=topic, type=samples.IMAGE, backends=backends)
        keys = publisher.do("send", topic=topic, value=samples.image(0, 640, 480))
        _compare(keys, ["_buf_cpu"])
    receiver.do("subscribe", topic=topic, type=samples.IMAGE, qos=samples.QOS)
    _deliver(topic, receiver, publisher, [samples.image(number, 640, 480) for number in range(3)], _APART)


def _compare(found: object, expected: object) -> None:
    if said := difference(found, expected):
        raise Failed(said)


def _short(type_name: str) -> str:
    return type_name.rpartition("/")[2]


def _name(what: str, receiver: Actor, suffix: str = "") -> str:
    """A name that no other check uses, by who receives."""
    return "_".join(part for part in (f"/to_{receiver.node}", what.lower(), suffix) if part)
