"""A description: entities in their order."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from launch.event_handler import as_list
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.logging import get_logger

if TYPE_CHECKING:
    from launch.action import Action
    from launch.actions import DeclareLaunchArgument
    from launch.launch_context import LaunchContext


class LaunchDescription(LaunchDescriptionEntity):
    """The content of a launch file."""

    def __init__(
        self,
        initial_entities: Iterable[LaunchDescriptionEntity] | None = None,
        *,
        deprecated_reason: str | None = None,
    ) -> None:
        super().__init__()
        self.entities: list[LaunchDescriptionEntity] = as_list(initial_entities)
        self.deprecated_reason = deprecated_reason

    @property
    def deprecated(self) -> bool:
        """Whether there is a reason not to use it any longer."""
        return self.deprecated_reason is not None

    def add_action(self, action: Action) -> None:
        """Add an action at the end."""
        self.add_entity(action)

    def add_entity(self, entity: LaunchDescriptionEntity) -> None:
        """Add an entity at the end."""
        self.entities.append(entity)

    def visit(self, context: LaunchContext) -> Sequence[LaunchDescriptionEntity]:
        """Return its entities."""
        if self.deprecated_reason is not None:
            get_logger().warning(f"this launch description is deprecated: {self.deprecated_reason}")
        return self.entities

    def describe_sub_entities(self) -> Sequence[LaunchDescriptionEntity]:
        """Return its entities."""
        return self.entities

    def get_launch_arguments(self, conditional_inclusion: bool = False) -> list[DeclareLaunchArgument]:
        """Return the arguments that it declares outside of other files, the first one of each name."""
        # It would import this module.
        from launch.actions import DeclareLaunchArgument

        found: dict[str, DeclareLaunchArgument] = {}

        def collect(entities: Iterable[LaunchDescriptionEntity], conditional: bool) -> None:
            for entity in entities:
                if isinstance(entity, DeclareLaunchArgument) and entity.name not in found:
                    entity.conditionally_included = conditional or entity.condition is not None
                    found[entity.name] = entity
                inside = conditional or getattr(entity, "condition", None) is not None
                collect(entity.describe_sub_entities(), inside)
                for _, others in entity.describe_conditional_sub_entities():
                    collect(others, True)

        collect(self.entities, conditional_inclusion)
        return list(found.values())
