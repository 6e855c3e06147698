"""Entities that follow the transitions of the managed node they belong to."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import TYPE_CHECKING, Any, overload

from ..impl.implementation_singleton import rclpy_implementation as _rclpy

if TYPE_CHECKING:
    from rclpy.impl.typed import P

    from .node import LifecycleState

TransitionCallbackReturn = _rclpy.TransitionCallbackReturnType


class ManagedEntity:
    """Something with a say in every transition; each callback gets the state before. By default it agrees."""

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Prepare for being active."""
        return TransitionCallbackReturn.SUCCESS

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Undo what `on_configure` did."""
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Give up everything for good."""
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Start working."""
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Stop working."""
        return TransitionCallbackReturn.SUCCESS

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Recover from a callback that failed badly: SUCCESS leads to unconfigured, all else to finalized."""
        return TransitionCallbackReturn.SUCCESS


class SimpleManagedEntity(ManagedEntity):
    """An entity that is enabled between activation and deactivation."""

    def __init__(self) -> None:
        self._enabled = False

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Enable it."""
        self._enabled = True
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Disable it."""
        self._enabled = False
        return TransitionCallbackReturn.SUCCESS

    @property
    def is_activated(self) -> bool:
        """Whether it is enabled."""
        return self._enabled

    @overload
    @staticmethod
    def when_enabled(
        wrapped: Callable[P, object], *, when_not_enabled: Callable[[], object] | None = None
    ) -> Callable[P, None]: ...
    @overload
    @staticmethod
    def when_enabled(
        wrapped: None = None, *, when_not_enabled: Callable[[], object] | None = None
    ) -> Callable[[Callable[P, object]], Callable[P, None]]: ...
    @staticmethod
    def when_enabled(
        wrapped: Callable[..., Any] | None = None,
        *,
        when_not_enabled: Callable[[], Any] | None = None,
    ) -> Callable[..., Any]:
        """Decorate a method that shall do nothing, or call `when_not_enabled`, unless the entity is enabled.

        The decorated method returns None in any case.
        """

        def decorate(method: Callable[..., Any]) -> Callable[..., None]:
            @wraps(method)
            def only_when_enabled(self: SimpleManagedEntity, *args: Any, **kwargs: Any) -> None:
                if self._enabled:
                    method(self, *args, **kwargs)
                elif when_not_enabled is not None:
                    when_not_enabled()

            return only_when_enabled

        return decorate if wrapped is None else decorate(wrapped)
