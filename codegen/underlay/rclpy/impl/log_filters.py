"""Filters that a logging call asks for by keywords: throttle, skip_first, once.

The state of a call's filters is a dictionary, its context. It belongs to the line that calls.
"""

from __future__ import annotations

from typing import Any, ClassVar

from rclpy.clock import Clock

Context = dict[str, Any]


class LoggingFilter:
    """Base of all filters."""

    params: ClassVar[dict[str, Any]] = {}  # keyword -> default; None: the caller must give it

    @classmethod
    def initialize_context(cls, context: Context, **kwargs: Any) -> None:
        """Put the parameters and the first state into a context."""
        for parameter, default in cls.params.items():
            value = kwargs.get(parameter, default)
            if value is None:
                raise TypeError(
                    f'Required parameter "{parameter}" was not specified for logging filter "{cls.__name__}"'
                )
            context[parameter] = value

    @staticmethod
    def should_log(context: Context) -> bool:
        """Decide, and note what the next decision needs."""
        return True


class Once(LoggingFilter):
    """Lets the first message through."""

    params: ClassVar[dict[str, Any]] = {"once": None}

    @classmethod
    def initialize_context(cls, context: Context, **kwargs: Any) -> None:
        """Note that nothing was logged yet."""
        super().initialize_context(context, **kwargs)
        context["has_been_logged_once"] = False

    @staticmethod
    def should_log(context: Context) -> bool:
        """Whether this is the first message."""
        logged, context["has_been_logged_once"] = context["has_been_logged_once"], True
        return not logged


class Throttle(LoggingFilter):
    """Lets a message through when the last one is long enough ago, by the clock that is given."""

    params: ClassVar[dict[str, Any]] = {"throttle_duration_sec": None, "throttle_time_source_type": Clock()}

    @classmethod
    def initialize_context(cls, context: Context, **kwargs: Any) -> None:
        """Check the clock. Raises ValueError if it is not a Clock."""
        super().initialize_context(context, **kwargs)
        context["throttle_last_logged"] = 0
        source = context["throttle_time_source_type"]
        if not isinstance(source, Clock):
            raise ValueError(f'Received throttle_time_source_type of "{source}" is not a clock instance')

    @staticmethod
    def should_log(context: Context) -> bool:
        """Whether the last message is long enough ago."""
        now = context["throttle_time_source_type"].now().nanoseconds
        if now < context["throttle_last_logged"] + context["throttle_duration_sec"] * 1e9:
            return False
        context["throttle_last_logged"] = now
        return True


class SkipFirst(LoggingFilter):
    """Lets all but the first message through."""

    params: ClassVar[dict[str, Any]] = {"skip_first": None}

    @classmethod
    def initialize_context(cls, context: Context, **kwargs: Any) -> None:
        """Note that nothing was skipped yet."""
        super().initialize_context(context, **kwargs)
        context["first_has_been_skipped"] = False

    @staticmethod
    def should_log(context: Context) -> bool:
        """Whether the first message was skipped."""
        skipped, context["first_has_been_skipped"] = context["first_has_been_skipped"], True
        return bool(skipped)


# In the order in which they decide; a program may add its own.
supported_filters: dict[str, type[LoggingFilter]] = {
    "throttle": Throttle,
    "skip_first": SkipFirst,
    "once": Once,
}


def get_filters_from_kwargs(**kwargs: Any) -> list[str]:
    """Return the names of the filters that these keywords ask for.

    :raises TypeError: for a keyword that no filter has, or if a filter's keyword is missing.
    """
    known = [parameter for kind in supported_filters.values() for parameter in kind.params]
    asked_for = [
        name
        for name, kind in supported_filters.items()
        if any(kwargs.get(parameter) for parameter in kind.params)
    ]
    for name in asked_for:
        for parameter, default in supported_filters[name].params.items():
            if default is None and parameter not in kwargs:
                raise TypeError(
                    f'required parameter "{parameter}" not specified '
                    f'but is required for the the logging filter "{name}"'
                )
    for keyword in kwargs:
        if keyword not in known:
            raise TypeError(f'parameter "{keyword}" is not one of the recognized logging options "{known}"')
    return asked_for
