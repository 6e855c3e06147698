"""The base of actions: what is done."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Self

from launch.condition import Condition
from launch.launch_description_entity import LaunchDescriptionEntity

if TYPE_CHECKING:
    from launch.frontend import Entity, Parser
    from launch.launch_context import LaunchContext


class Action(LaunchDescriptionEntity):
    """Something to do, if its condition holds."""

    def __init__(self, *, condition: Condition | None = None) -> None:
        super().__init__()
        self.condition = condition

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> tuple[type[Self], dict[str, Any]]:
        """Return the class, and its arguments as an element of XML or YAML has them. Raises LaunchError.

        A class of users calls it for what its base takes, and adds its own.
        """
        return cls, parser.arguments(cls, entity)

    def visit(self, context: LaunchContext) -> Sequence[LaunchDescriptionEntity] | None:
        """Do it unless its condition says otherwise, and return what to visit next."""
        if self.condition is not None and not self.condition.evaluate(context):
            return None
        following = self.execute(context)
        if not self.ends_later():
            context.host.completed(self)
        return following

    def execute(self, context: LaunchContext) -> Sequence[LaunchDescriptionEntity] | None:
        """Do it whatever its condition, and return what to visit next."""
        return None

    def ends_later(self) -> bool:
        """Whether it goes on after `execute`, as a process does."""
        return False
