"""Definitions of recorded types: of classes for bags, and of bags for comparisons."""

from __future__ import annotations

from typing import Any

from ifgen_runtime.bag.definitions import full_text
from ifgen_runtime.bag.qos import OfferedQoS
from ifgen_runtime.bag.topics import Channel, Definition
from ifgen_runtime.type_description import type_hash, type_name


def channel_of(topic: str, cls: type[Any], qos: tuple[OfferedQoS, ...]) -> Channel:
    """The channel for the messages of a class."""
    hashed = getattr(cls, "__type_hash__", None) or type_hash(cls)
    return Channel(topic, Definition(type_name(cls), hashed, "ros2msg", full_text(cls)), qos)
