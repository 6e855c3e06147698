"""The local transport's knowledge of other processes, which rclpy's public API does not tell.

This is the one module of the tools that looks below rclpy.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Final

# Late imports: there is no rmw_local beside a real rclpy.

_PATIENCE: Final = 2.0
"""Seconds for which answers to a survey come."""


def knows_everybody(domain: int) -> bool:
    """Whether the graph of a ROS domain has everybody who was there before this process's first node."""
    from rmw_local.domain import Domain

    found = Domain.numbered(domain).discovery
    return found is None or found.knows_everybody()


def lacks_zenoh(domain: int) -> bool:
    """Whether other processes are there, but not reached because Zenoh is not installed."""
    from rmw_local.domain import Domain

    found = Domain.numbered(domain).discovery
    return found is not None and found.lacks_zenoh()


def survey(domain: int) -> Callable[[], Iterable[bytes]]:
    """Ask all processes in a ROS domain for their statistics; returns what returns the answers so far."""
    from rmw_local.domain import Domain
    from rmw_local.statistics import survey

    return survey(Domain.numbered(domain), _PATIENCE)


def queues(domain: int) -> dict[tuple[int, ...], tuple[str, int]]:
    """The history and the depth of each end of a topic by gid, which rclpy's graph leaves out as DDS does."""
    from rmw_local.domain import Domain
    from rmw_local.qos import KEEP_ALL, KEEP_LAST

    names = {KEEP_LAST: "KEEP_LAST", KEEP_ALL: "KEEP_ALL"}
    here = Domain.numbered(domain)
    here.close_pending()
    with here.lock:
        ends = [end for topic in here.topics.values() for end in (*topic.writers, *topic.readers)]
        return {
            tuple(end.gid): (names[end.qos.history], end.qos.depth)
            for end in ends
            if end.qos.history in names
        }


def service_hashes(domain: int) -> dict[tuple[int, ...], str]:
    """The type hash of the whole service for each server and client by gid; other processes tell no other."""
    from rmw_local.domain import Domain

    here = Domain.numbered(domain)
    here.close_pending()
    with here.lock:
        ends = [end for service in here.services.values() for end in (*service.servers, *service.clients)]
        return {tuple(end.gid): end.service_type.type_hash for end in ends}
