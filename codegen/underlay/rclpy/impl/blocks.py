"""Entities in a `with` block, which newer ROS has."""

from __future__ import annotations

import weakref
from types import TracebackType
from typing import TYPE_CHECKING, Any, ClassVar

from rclpy.impl import distro

if TYPE_CHECKING:
    from typing import Self

    from rclpy.node import Node


class Block:
    """A mixin for what a `with` block destroys at its end.

    `_ros_entity` is its name in `distro.API`, and `_ros_end` the method that destroys it.
    """

    _ros_entity: ClassVar[str]
    _ros_end: ClassVar[str] = "destroy"

    def __enter__(self) -> Self:
        distro.uses(self._ros_entity)
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exc_tb: TracebackType | None,
    ) -> None:
        getattr(self, self._ros_end)()


class Owned(Block):
    """A mixin for an entity that its node lists; in newer ROS, until it is destroyed."""

    _owner: weakref.ref[Node] | None = None

    def destroy(self) -> None:
        """Destroy it."""
        entity: Any = super()
        entity.destroy()
        node = None if self._owner is None else self._owner()
        if node is not None:
            node._forget(self)
