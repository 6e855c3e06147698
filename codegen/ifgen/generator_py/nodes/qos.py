"""QoS profiles as Python text."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from ifgen.generator_py.nodes.text import call
from ifgen.nodl.model import QosProfile


def profile(qos: QosProfile, imports: Callable[[str], str]) -> str:
    """The call that makes a profile; what the description leaves open is rclpy's default."""
    return call(imports("QoSProfile"), arguments(qos, imports), indent=0)


def arguments(qos: QosProfile, imports: Callable[[str], str]) -> Iterator[str]:
    """The arguments of a profile; `imports` gets the names that they need."""
    yield f"history={imports('HistoryPolicy')}.{qos.history}"
    if qos.depth:
        yield f"depth={qos.depth}"
    yield f"reliability={imports('ReliabilityPolicy')}.{qos.reliability}"
    if qos.durability:
        yield f"durability={imports('DurabilityPolicy')}.{qos.durability}"
    durations = (("deadline", qos.deadline_ns), ("lifespan", qos.lifespan_ns))
    for name, nanoseconds in durations:
        if nanoseconds:
            yield _duration(name, nanoseconds, imports)
    if qos.liveliness:
        yield f"liveliness={imports('LivelinessPolicy')}.{qos.liveliness}"
    if qos.liveliness_lease_duration_ns:
        yield _duration("liveliness_lease_duration", qos.liveliness_lease_duration_ns, imports)


def _duration(name: str, nanoseconds: int, imports: Callable[[str], str]) -> str:
    return f"{name}={imports('Duration')}(nanoseconds={nanoseconds:_})"
