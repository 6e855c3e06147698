"""The parts that this machine has, and how to get the rest."""

from __future__ import annotations

import importlib.util
import os
import platform
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import lark
from ifgen import resources
from ifgen.activation import reason_against_domain
from ifgen.config import installing
from ifgen_runtime.codec import choice
from ifgen_runtime.domains import neighbours
from ifgen_runtime.installation import NATIVE

from ifgen_tools.running import elsewhere

_TIME_LIMIT = 60.0  # [s] for asking real rclpy
_LOG_HEAD = re.compile(r"^(\[[^]]*\] ?)+: ")  # level, time and name of who says it

_OK = "ok "
_WITH_WHEELS = ("jazzy", "kilted")
_TESTED = _WITH_WHEELS  # the native tests run on the wheels


@dataclass(frozen=True, slots=True)
class Component:
    """One thing looked at: what it is, what was found, and, where something is missing, what to do."""

    subject: str
    found: str
    advice: str | None = None


def examine() -> Iterator[Component]:
    """Look at everything that decides what ifgen can do here; takes as long as starting real rclpy does."""
    system = f"{platform.system()} {platform.machine()}"
    yield Component("ifgen", f"{resources.VERSION} in {resources.PACKAGE} ({installing.origin()})")
    yield _runtime()
    yield Component("Python", f"{platform.python_version()} on {system}, {sys.executable}")
    # Asked of the module: lark and lark-parser overwrite each other's files, not each other's records.
    yield Component("lark", str(lark.__version__))
    yield _codec()
    yield Component("local transport", "works anywhere: ifgen run --transport local PROGRAM")
    yield _other_processes()
    yield Component("nodes", neighbours.everywhere() or "none of this user run on this machine now")
    if reason := reason_against_domain("rclpy"):
        yield Component("ROS domain", reason)
    yield from _real_rclpy(system)


def _other_processes() -> Component:
    """Whether the local transport leaves its process."""
    number = _version("eclipse-zenoh")
    if number is None:
        return Component("other processes", "not reached: Zenoh is missing", installing.add_runtime())
    found, advice = elsewhere.look()
    return Component("other processes", f"{found} (Zenoh {number})", advice)


def _runtime() -> Component:
    """The folder from which packages import `ifgen_runtime`; says if another ifgen's copy hides ours."""
    spec = importlib.util.find_spec("ifgen_runtime")
    home = Path(spec.origin).parent if spec and spec.origin else None
    ours = resources.PACKAGE.parent / "ifgen_runtime"
    if ours.is_dir() and home and not home.samefile(ours):
        return Component("runtime", f"in {home}, which hides the one in {ours}", installing.add_runtime())
    return Component("runtime", f"in {home}")


def _codec() -> Component:
    """Which codec serialises messages here, and why."""
    codec = choice.chosen()
    number = _version(NATIVE)
    if codec.extension:
        return Component("codec", f"in C, by {NATIVE} {number or 'of unknown version'}")
    can_be_had = sys.implementation.name == "cpython" and platform.system() == "Linux"
    advice = installing.add_native() if can_be_had and number is None else None
    return Component("codec", f"in Python (slower): {codec.reason}", advice)


def _real_rclpy(system: str) -> Iterator[Component]:
    if importlib.util.find_spec("rclpy") is None:
        advice = "source /opt/ros/jazzy/setup.sh"
        if system == "Linux x86_64":
            advice += f", or {installing.add_extra('ros')}"
        yield Component("real rclpy", "not found", advice)
        return
    lines = _ask_real()
    if len(lines) < 3:  # what `real_rclpy` prints
        reason = "; ".join(lines) or "`import rclpy` in Python says more"
        chosen = os.environ.get("RMW_IMPLEMENTATION")
        if chosen and chosen in reason:
            yield Component(
                "real rclpy",
                f"does not start with RMW_IMPLEMENTATION={chosen}",
                f"unset it, or set RMW_IMPLEMENTATION=rmw_fastrtps_cpp; it says: {reason}",
            )
        else:
            yield Component("real rclpy", "cannot be imported", reason)
        return
    home, rmw, type_support = lines[0], lines[1], "\n".join(lines[2:])
    number = _version("ros-rclpy") or _version("rclpy") or "of unknown version"
    distribution, witness = _distribution(home)
    sourced = os.environ.get("ROS_DISTRO", distribution)
    yield Component(
        "real rclpy",
        f"{number} (ROS 2 {distribution}: {witness}) in {home}",
        None
        if sourced == distribution
        else f"ROS_DISTRO says {sourced}: unset it, or source that distribution",
    )
    yield Component("middleware", rmw)
    if type_support.startswith(_OK):
        found = f"{type_support.removeprefix(_OK)}: never-compiled packages work"
        if distribution not in _TESTED:
            found += f"; symbols and layouts fit, but its tests were never run on {distribution}"
        yield Component("type support", found)
    else:
        yield Component("type support", "not usable: on real rclpy only compiled packages work", type_support)


def _distribution(home: str) -> tuple[str, str]:
    """The distribution that a real rclpy at `home` belongs to, and how one knows."""
    if installed := re.search(r"/opt/ros/([a-z]+)/", home):
        return installed[1], "by its folder"
    for name in _WITH_WHEELS:
        if _version(f"ros-{name}-rclpy"):
            return name, "by its wheels"
    if sourced := os.environ.get("ROS_DISTRO"):
        return sourced, "by ROS_DISTRO"
    return "unknown", "no ROS_DISTRO, no wheels"


def _ask_real() -> list[str]:
    try:
        asked = subprocess.run(
            [sys.executable, "-m", "ifgen_tools.doctor.real_rclpy"],
            env=elsewhere.usable_environment(),
            capture_output=True,
            text=True,
            timeout=_TIME_LIMIT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return ["its import did not finish within a minute"]
    if asked.returncode:
        return [_LOG_HEAD.sub("", line) for line in asked.stderr.strip().splitlines()[-1:]]
    return asked.stdout.strip().splitlines()


def _version(distribution: str) -> str | None:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return None
