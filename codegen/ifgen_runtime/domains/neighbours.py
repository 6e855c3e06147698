"""The nodes that run on this machine: on which transport, and in which ROS domain.

A user who looks at one transport learns nothing of nodes on the other. This module asks without joining
either, in at most `LIMIT` seconds. The doorbells of the local transport say how many nodes they have. A
middleware of DDS is not asked, because discovery takes seconds. A program on the real rclpy is one that has
loaded rcl, and its UDP ports stand for its domain by a rule of RTPS (section 9.6.1.1 of the specification).

This finds programs of this user on this machine; those on the real rclpy on Linux only. It does not find
local programs that use a router or a file of Zenoh's configuration.
"""

from __future__ import annotations

import _socket  # socket itself takes 3 ms to import, and every program with a doorbell imports this module
import os
import re
import time
from contextlib import suppress
from pathlib import Path

TYPE_CHECKING = False  # typing itself takes longer to import than this module
if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from typing import Final

LIMIT: Final = 0.2
"""Seconds for which programs may answer."""

FOLDER: Final = Path("/tmp")
"""The folder with a folder for each user, `ifgen-UID`, which has one for each domain with its doorbells."""

BELL: Final = ".bell"
"""The ending of a doorbell: a datagram socket of a process that can be reached."""

COUNT: Final = b"n"
"""The question for the number of visible nodes. The answer is that number in decimal digits."""

_PROC: Final = Path("/proc")
_RCL: Final = b"/librcl.so"
_BY_DOMAIN: Final = 250  # RTPS: the ports of domain D begin at 7400 + 250 D
_FIRST_PORT: Final = 7400
_UNICAST: Final = 10  # the offset of the first participant, which has two ports, as all after it
_DOMAINS: Final = 233
_TOOLS: Final = ("ros2", "ifgen")
_RUNNERS: Final = ("bag", "demo", "launch", "run", "test")  # commands of ifgen whose nodes are the user's
_NAMES: Final = {"local": "the local transport", "rclpy": "the real rclpy"}
_MOST: Final = 3  # places in one sentence


class Nodes:
    """A number of nodes in one place; `is_least` if there may be more."""

    def __init__(self, number: int = 0, *, is_least: bool = False) -> None:
        self.number = number
        self.is_least = is_least

    def add(self, number: int, *, is_least: bool = False) -> None:
        """Add further ones."""
        self.number += number
        self.is_least = self.is_least or is_least

    def __str__(self) -> str:
        few = "at least " if self.is_least else ""
        return f"{few}1 node runs" if self.number == 1 else f"{few}{self.number} nodes run"


def elsewhere(transport: str, domain: int) -> str:
    """Say where nodes run, other than on this transport in this domain; empty if none are found.

    Other domains are named only if the other transport has nobody in this domain, and IFGEN_OTHER_DOMAINS is
    not 0. Nothing is named under ROS_AUTOMATIC_DISCOVERY_RANGE=OFF, where no other process can be seen.
    """
    if _is_off():
        return ""
    other = _other(transport)
    found = {(other, number): nodes for number, nodes in _everybody(other).items()}
    if (other, domain) in found:
        return _sentence((other, domain), found[other, domain], transport, domain)
    if os.environ.get("IFGEN_OTHER_DOMAINS") == "0":
        return ""
    mine = _everybody(transport)
    found |= {(transport, number): nodes for number, nodes in mine.items() if number != domain}
    most = sorted(found, key=lambda place: -found[place].number)[:_MOST]
    return "; ".join(_sentence(place, found[place], transport, domain) for place in most)


def on_other(transport: str, domain: int) -> str:
    """Say how many nodes run in this domain on the other transport; empty if none are found."""
    other = _other(transport)
    nodes = None if _is_off() else _everybody(other).get(domain)
    return "" if nodes is None else _sentence((other, domain), nodes, transport, domain)


def is_elsewhere_only(transport: str, domain: int) -> bool:
    """Whether nodes run in this domain on the other transport, and none on this one.

    It costs next to nothing where nobody is there.
    """
    if _is_off():
        return False
    if transport == "local":
        return bool(_ports_of(domain)) and domain in on_real_rclpy() and domain not in on_local(domain)
    return domain in on_local(domain) and domain not in on_real_rclpy()


def is_here(transport: str, domain: int) -> bool:
    """Whether nodes run on this transport in this domain; those of this process count on the local one."""
    return domain in (on_local(domain) if transport == "local" else on_real_rclpy())


def everywhere() -> str:
    """Say where nodes run; empty if none are found."""
    found = {(transport, number): n for transport in _NAMES for number, n in _everybody(transport).items()}
    return "; ".join(f"{nodes} {_where(*place)}" for place, nodes in sorted(found.items()))


def on_local(domain: int | None = None) -> dict[int, Nodes]:
    """The visible nodes on the local transport by domain, or of one domain."""
    if not hasattr(os, "getuid"):
        return {}  # Windows has no such sockets
    home = FOLDER / f"ifgen-{os.getuid()}"
    bells = list(_bells(home, domain))
    if not bells:
        return {}
    asking = _socket.socket(_socket.AF_UNIX, _socket.SOCK_DGRAM)
    address = home / f"{os.getpid()}-{time.monotonic_ns()}.asks"
    found: dict[int, Nodes] = {}
    try:
        asking.bind(str(address))
        asked = {str(bell): number for number, bell in bells if _is_asked(asking, bell)}
        for bell, count in _answers(asking, len(asked)):
            number = asked.pop(bell, None)
            if number is not None and count:
                found.setdefault(number, Nodes()).add(count)
    except OSError:
        return {}
    finally:
        asking.close()
        with suppress(OSError):
            address.unlink()
    for number in asked.values():  # too busy to answer; whoever has a doorbell has a node
        found.setdefault(number, Nodes()).add(1, is_least=True)
    return found


def on_real_rclpy() -> dict[int, Nodes]:
    """The least number of nodes on a real ROS by domain: one for each program in that domain."""
    ports = _ports()
    found: dict[int, Nodes] = {}
    for process in _programs_on_ros():
        for domain in _domains(process, ports):
            found.setdefault(domain, Nodes()).add(1, is_least=True)
    return found


def _is_off() -> bool:
    return os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE") == "OFF"


def _other(transport: str) -> str:
    return "rclpy" if transport == "local" else "local"


def _everybody(transport: str) -> dict[int, Nodes]:
    return on_local() if transport == "local" else on_real_rclpy()


def _sentence(place: tuple[str, int], nodes: Nodes, transport: str, domain: int) -> str:
    where, number = place
    way = [] if number == domain else [f"ROS_DOMAIN_ID={number}"]
    way += [] if where == transport else [f"--transport {where}"]
    return f"{nodes} {_where(where, None if number == domain else number)}: {' and '.join(way)}"


def _where(transport: str, domain: int | None) -> str:
    return f"on {_NAMES[transport]}{'' if domain is None else f' in domain {domain}'}"


def _bells(home: Path, domain: int | None) -> Iterator[tuple[int, Path]]:
    try:
        if home.lstat().st_uid != os.getuid():
            return
    except OSError:
        return
    for bell in home.glob(f"{'*' if domain is None else domain}/*{BELL}"):
        if bell.parent.name.isdecimal():
            yield int(bell.parent.name), bell


def _is_asked(asking: _socket.socket, bell: Path) -> bool:
    try:
        asking.sendto(COUNT, _socket.MSG_DONTWAIT, str(bell))
    except OSError as error:
        return isinstance(error, BlockingIOError)  # so busy that nobody has read the last ones
    return True


def _answers(asking: _socket.socket, number: int) -> Iterator[tuple[str, int]]:
    """The answers until all have come, or the time is over."""
    end = time.monotonic() + LIMIT
    while number and (left := end - time.monotonic()) > 0:
        asking.settimeout(left)
        try:
            answer, bell = asking.recvfrom(16)
        except OSError:  # TimeoutError is one
            return
        if answer.isdigit():
            number -= 1
            yield bell, int(answer)


def _ports() -> dict[str, int]:
    """The UDP ports that are bound on this machine, by the inodes of their sockets."""
    found: dict[str, int] = {}
    for table in ("udp", "udp6"):
        with suppress(OSError):
            for line in (_PROC / "net" / table).read_text().splitlines()[1:]:
                words = line.split()
                found[words[9]] = int(words[1].rpartition(":")[2], 16)
    return found


def _ports_of(domain: int) -> list[int]:
    """The bound ports that a domain would have."""
    first = _FIRST_PORT + _BY_DOMAIN * domain
    return [port for port in _ports().values() if first <= port < first + _BY_DOMAIN]


def _programs_on_ros() -> Iterator[Path]:
    """The processes of this user that have loaded rcl, except this one and tools."""
    with suppress(OSError):
        for process in _PROC.iterdir():
            if process.name.isdecimal() and int(process.name) != os.getpid():
                with suppress(OSError):  # gone meanwhile, or somebody else's
                    if _RCL in (process / "maps").read_bytes() and not _is_tool(process):
                        yield process


def _is_tool(process: Path) -> bool:
    line = (process / "cmdline").read_bytes()
    words = [Path(os.fsdecode(word)).name for word in line.split(b"\0")]
    if "ros2-daemon" in words:
        return True
    starters = [place for place, word in enumerate(words[:3]) if word in _TOOLS]
    return bool(starters) and words[starters[0] + 1] not in _RUNNERS


def _domains(process: Path, ports: dict[str, int]) -> Iterable[int]:
    """The domains of a program: by its ports, or by its environment if its middleware has others."""
    bound = set[int]()
    for entry in (process / "fd").iterdir():
        with suppress(OSError):
            if (socket := re.fullmatch(r"socket:\[(\d+)\]", str(entry.readlink()))) and socket[1] in ports:
                bound.add(ports[socket[1]])
    found = {(port - _FIRST_PORT) // _BY_DOMAIN for port in bound if _is_of_rtps(port, bound)}
    if found or not (bound or b"/librmw_zenoh" in (process / "maps").read_bytes()):
        return found
    variables = (process / "environ").read_bytes().split(b"\0")
    start = b"ROS_DOMAIN_ID="
    chosen = next((each.removeprefix(start) for each in variables if each.startswith(start)), b"")
    return [int(chosen)] if chosen.isdigit() else [0]


def _is_of_rtps(port: int, bound: set[int]) -> bool:
    """Whether a port is the one for multicast, or the first of the two of a participant."""
    domain, offset = divmod(port - _FIRST_PORT, _BY_DOMAIN)
    if not 0 <= domain < _DOMAINS:
        return False
    return offset == 0 or (offset >= _UNICAST and offset % 2 == 0 and port + 1 in bound)
