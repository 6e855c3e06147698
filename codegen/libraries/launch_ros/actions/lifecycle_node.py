# Events of any kind are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Managed nodes, and transitions of theirs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from launch.action import Action
from launch.condition import Condition
from launch.conditions import evaluate_condition_expression
from launch.event import Event
from launch.event_handler import EventHandler
from launch.launch_context import LaunchContext
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.utilities import performed

from launch_ros.actions.node import Node
from launch_ros.events.lifecycle import ChangeState, StateTransition
from launch_ros.events.matchers import matches_node_name

_CONFIGURE, _ACTIVATE = 1, 3
_GOALS = {1: "inactive", 2: "unconfigured", 3: "active", 4: "inactive"}
_FINALIZED = "finalized"


class LifecycleNode(Node):
    """A managed node, which answers `ChangeState` and emits `StateTransition`; `autostart` activates it."""

    def __init__(
        self,
        *,
        name: SomeSubstitutionsType,
        namespace: SomeSubstitutionsType,
        autostart: bool | SomeSubstitutionsType = False,
        **kwargs: Any,
    ) -> None:
        super().__init__(name=name, namespace=namespace, **kwargs)
        self.autostart = str(autostart) if isinstance(autostart, bool) else autostart

    @property
    def is_lifecycle_node(self) -> bool:
        """True."""
        return True

    def execute(self, context: LaunchContext) -> Sequence[LaunchDescriptionEntity] | None:
        """Start the process, and watch its transitions. Raises RuntimeError."""
        super().execute(context)
        name = self.node_name
        # It imports an rclpy, which few launches need.
        from launch_ros.ros_adapters import get_ros_adapter

        adapter = get_ros_adapter(context)
        adapter.watch(
            name, lambda message: context.emit_event_sync(StateTransition(action=self, msg=message))
        )

        def asked(event: Any) -> bool:
            return isinstance(event, ChangeState) and event.lifecycle_node_matcher(self)

        context.register_event_handler(_Doing(asked, lambda event: adapter.change(name, event.transition_id)))
        if evaluate_condition_expression(context, self.autostart):
            _make(context, name, [_CONFIGURE, _ACTIVATE])
        return None


class LifecycleTransition(Action):
    """Transitions of managed nodes, one after the other in each of them."""

    def __init__(
        self,
        *,
        lifecycle_node_names: Iterable[SomeSubstitutionsType],
        transition_ids: Iterable[int | SomeSubstitutionsType],
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.lifecycle_node_names = list(lifecycle_node_names)
        self.transition_ids = list(transition_ids)
        if not self.lifecycle_node_names or not self.transition_ids:
            raise RuntimeError("LifecycleTransition needs names of nodes and ids of transitions")

    def execute(self, context: LaunchContext) -> None:
        """Ask each node for the first transition, and for the next one when it is made."""
        ids = [
            each if isinstance(each, int) else int(performed(context, each)) for each in self.transition_ids
        ]
        for each in self.lifecycle_node_names:
            _make(context, performed(context, each), ids)


class _Doing(EventHandler):
    """Calls a function for each event that it matches."""

    def __init__(self, matcher: Any, call: Any, *, handle_once: bool = False) -> None:
        super().__init__(matcher=matcher, handle_once=handle_once)
        self._call = call

    def handle(self, event: Event, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Call it."""
        super().handle(event, context)
        self._call(event)
        return []


def _make(context: LaunchContext, name: str, ids: list[int]) -> None:
    """Ask for transitions of a node, each after the one before has reached its goal."""
    matches = matches_node_name(name)
    following = ids[1:]
    if following:
        goal = _GOALS.get(ids[0], _FINALIZED)

        def reached(event: Any) -> bool:
            return isinstance(event, StateTransition) and matches(event.action) and event.goal_state == goal

        then = _Doing(reached, lambda event: _make(context, name, following), handle_once=True)
        context.register_event_handler(then)
    context.emit_event_sync(ChangeState(lifecycle_node_matcher=matches, transition_id=ids[0]))
