"""The match of QoS profiles, by the rules of DDS, which every ROS 2 middleware follows."""

from __future__ import annotations

from ifgen.nodl.model import QosProfile


def mismatch(offered: QosProfile, requested: QosProfile) -> str | None:
    """The reason why an offered profile does not satisfy a requested one; None if it does, or may.

    A policy that a profile leaves to the middleware may turn out either way, so it is no mismatch; deadline,
    lifespan and lease of 0 ns stand for infinite. Source: REP-2003, DDS 1.4 section 2.2.3.
    """
    if offered.reliability == "BEST_EFFORT" and requested.reliability == "RELIABLE":
        return "BEST_EFFORT is offered, RELIABLE requested"
    # rmw's default durability is volatile.
    if (offered.durability or "VOLATILE") == "VOLATILE" and requested.durability == "TRANSIENT_LOCAL":
        return "VOLATILE is offered, TRANSIENT_LOCAL requested"
    if requested.deadline_ns and not 0 < offered.deadline_ns <= requested.deadline_ns:
        what = f"a deadline of {_ms(offered.deadline_ns)}" if offered.deadline_ns else "no deadline"
        return f"{what} is offered, one of {_ms(requested.deadline_ns)} requested"
    if (offered.liveliness or "AUTOMATIC") == "AUTOMATIC" and requested.liveliness == "MANUAL_BY_TOPIC":
        return "AUTOMATIC liveliness is offered, MANUAL_BY_TOPIC requested"
    lease, asked = offered.liveliness_lease_duration_ns, requested.liveliness_lease_duration_ns
    if asked and not 0 < lease <= asked:
        what = f"a lease of {_ms(lease)}" if lease else "no lease"
        return f"{what} is offered, one of {_ms(asked)} requested"
    return None


def _ms(nanoseconds: int) -> str:
    return f"{nanoseconds / 1e6:g} ms"
