"""Tells of payloads that were dropped because they are no message of their type."""

from __future__ import annotations

from rmw_local.notices import Repeated


class Drops(Repeated):
    """Counts the payloads of one type that could not be read; `type_name` is `pkg/kind/Name`.

    The type support for real rclpy does the same, in the same words.
    """

    def __init__(self, type_name: str) -> None:
        name = type_name.replace("/", "::")
        super().__init__(
            f"dropped {{count}} malformed message{{s}} of type {name} "
            "(does a publisher have another definition of it?)"
        )
