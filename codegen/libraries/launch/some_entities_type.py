"""Everything that can be written where entities are wanted."""

from collections.abc import Iterable
from typing import TypeAlias

from launch.launch_description_entity import LaunchDescriptionEntity

SomeEntitiesType: TypeAlias = LaunchDescriptionEntity | Iterable[LaunchDescriptionEntity]
"""One entity or several."""

SomeEntitiesType_types_tuple = (LaunchDescriptionEntity, Iterable)
"""The same for `isinstance`."""
