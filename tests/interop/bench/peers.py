"""The other implementations: what each needs, which of our programs speaks for it, and what it lacks."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

from tests.interop.bench import samples
from tests.interop.bench.outcomes import Feature

_ON_TOPICS: Final = (samples.STRING, samples.JOINT_STATE, samples.IMU)
_NO_BUFFERS: Final = {Feature.BUFFERS: "it has no buffer backends"}


@dataclass(frozen=True, slots=True)
class Known:
    """A failure of a peer that is known: why, and the error, as a regular expression.

    `sometimes`: the check may work as well. Otherwise, one that works is to be taken off the list.
    """

    reason: str
    error: str
    sometimes: bool = False


_VOLATILE_STATUS: Final = Known(
    "an action server of dora-rs on DDS has a volatile status, which rclpy does not take", "no server of "
)


@dataclass(frozen=True, slots=True)
class Peer:
    """An implementation. `requirements` are for pip; the first names its distribution.

    Its version must be `oldest` or later, and earlier than `before`, if there is one.
    `lacking` has the reasons for features that are not tried. `known` has what is wrong in it, by the name of
    a check in a feature: such a check is tried, and has to fail in this way. A peer with a `bridge` does not
    speak Zenoh: that program stands between. One that is `on_dds` meets our classes on real rclpy.
    """

    name: str
    program: str
    requirements: tuple[str, ...]
    oldest: tuple[int, ...]
    before: tuple[int, ...] = ()
    types: tuple[str, ...] = _ON_TOPICS
    lacking: Mapping[Feature, str] = field(default_factory=lambda: _NO_BUFFERS)
    known: Mapping[tuple[Feature, str], Known] = field(default_factory=dict[tuple[Feature, str], Known])
    bridge: str = ""
    on_dds: bool = False
    simulated: bool = False

    @property
    def distribution(self) -> str:
        """The name of its distribution on PyPI."""
        return self.requirements[0].partition("=")[0]

    def refusal(self, version: str) -> str:
        """Why its checks cannot be made with this version; empty if they can."""
        numbers = tuple(int(part) for part in re.findall(r"\d+", version)[:3])
        if not numbers:
            return f"{self.distribution} is not installed"
        if self.oldest <= numbers and not (self.before and numbers >= self.before):
            return ""
        needed = ".".join(map(str, self.oldest))
        return f"{self.distribution} {version} is installed, {needed}{'.x' if self.before else ''} is needed"


def _all_but(feature: Feature, reason: str) -> dict[Feature, str]:
    return {other: reason for other in Feature if other is not feature}


def _ros(distribution: str, major: int) -> Peer:
    packages = ("rclpy", "rmw-fastrtps-cpp", "common-interfaces", "test-msgs")
    return Peer(
        name=distribution.capitalize(),
        program="rclpy_program.py",
        requirements=("ros-rclpy", *(f"ros-{distribution}-{package}" for package in packages)),
        oldest=(major,),
        before=(major + 1,),
        lacking={
            Feature.GRAPH: "the bridge has a node of its own, which stands for all",
            Feature.BUFFERS: "it speaks DDS, which has none of these keys",
        },
        known={
            (Feature.ACTION, "their client"): _VOLATILE_STATUS,
            (Feature.IMAGE, "6.2 MB from us"): Known(
                "dora-rs on DDS loses large messages now and then", r"\d came, expected 2", sometimes=True
            ),
        },
        bridge="bridge_program.py",
    )


PEERS: Final = (
    Peer("dora-rs", "dora_program.py", ("dora-rs==1.1.0", "numpy"), (1, 1)),
    Peer(
        "zenoh-ros2-sdk",
        "sdk_program.py",
        ("zenoh-ros2-sdk==0.1.8",),
        (0, 1, 8),
        known={
            (Feature.TRANSIENT_LOCAL, "to us"): Known("its publishers keep nothing", "0 came, expected 3"),
            (Feature.TRANSIENT_LOCAL, "from us"): Known(
                "it lets Zenoh consolidate what was kept to the last message", "1 came, expected 3"
            ),
            (Feature.PARAMETER, "ours"): Known(
                "it does not find messages of a service's own package", "no answer within"
            ),
        },
    ),
    Peer("pyzeros", "pyzeros_program.py", ("pyzeros==0.1.0", "ros2-pyterfaces", "eclipse-zenoh"), (0, 1)),
    Peer(
        "pamoja-ros2",
        "pamoja_program.py",
        ("pamoja-ros2==0.2.0", "eclipse-zenoh"),
        (0, 2),
        types=(samples.TWIST,),
        lacking=_all_but(Feature.TOPIC, "it makes names and encodes Twist, and has no session of its own"),
    ),
    _ros("jazzy", 7),
    _ros("kilted", 9),
    Peer(
        "Cyclone DDS",
        "cyclone_program.py",
        ("cyclonedds==11.0.1",),
        (11,),
        lacking={
            feature: "it has topics only"
            for feature in Feature
            if feature not in (Feature.TOPIC, Feature.TRANSIENT_LOCAL, Feature.IMAGE)
        },
        known={
            (Feature.IMAGE, f"{size} {direction} us"): Known(
                "it and Fast DDS lose large messages on a busy machine",
                r"\d came, expected 2",
                sometimes=True,
            )
            for size in ("0.9 MB", "6.2 MB")
            for direction in ("to", "from")
        },
        on_dds=True,
    ),
    Peer(
        "Lyrical",
        "lyrical_program.py",
        ("eclipse-zenoh", "xxhash"),
        (1,),
        lacking=_all_but(Feature.BUFFERS, "no wheel has it: only its choice of keys for images is simulated"),
        simulated=True,
    ),
)
"""Every implementation of the table, in its order."""
