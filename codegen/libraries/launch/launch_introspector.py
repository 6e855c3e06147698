"""Descriptions as trees, for people."""

from __future__ import annotations

from collections.abc import Iterator

from launch.launch_description_entity import LaunchDescriptionEntity


class LaunchIntrospector:
    """Prints what descriptions contain."""

    def format_launch_description(self, launch_description: LaunchDescriptionEntity) -> str:
        """Return the tree of a description, a line for each entity."""
        return "\n".join(tree(launch_description))


def tree(entity: LaunchDescriptionEntity, *, first: str = "", rest: str = "") -> Iterator[str]:
    """Return the lines of an entity, and of what is inside."""
    condition = getattr(entity, "condition", None)
    yield f"{first}{entity.describe()}{f' [{condition.describe()}]' if condition else ''}"
    inside: list[tuple[str, LaunchDescriptionEntity]] = [
        ("", each) for each in entity.describe_sub_entities()
    ]
    for case, entities in entity.describe_conditional_sub_entities():
        inside += [(f"({case}) ", each) for each in entities]
    for number, (case, each) in enumerate(inside, 1):
        is_last = number == len(inside)
        first_mark, rest_mark = ("└── ", "    ") if is_last else ("├── ", "│   ")
        yield from tree(each, first=rest + first_mark + case, rest=rest + rest_mark)
