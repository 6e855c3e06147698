"""Types of rclpy for type checkers, and the classes of rclpy that take type arguments at run time.

Jazzy's classes take none. Those of newer ROS do, with other parameters than ours have for type checkers:
`Client[Request, Response]`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine
    from typing import Any, ParamSpec, Protocol, TypeAlias
    from typing import Generic as Generic  # noqa: PLC0414 - modules import it from here

    from ifgen_runtime.interface import Action as Action  # noqa: PLC0414 - modules import it from here
    from ifgen_runtime.interface import HasViews as HasViews  # noqa: PLC0414 - modules import it from here
    from ifgen_runtime.interface import Service as Service  # noqa: PLC0414 - modules import it from here
    from typing_extensions import TypeVar  # checkers know it without its being installed

    # Those of classes have defaults: `Future` alone stands for `Future[Any]`, as programs have written it.
    T = TypeVar("T", default=Any)
    T_co = TypeVar("T_co", covariant=True)
    P = ParamSpec("P")
    MessageT = TypeVar("MessageT", default=Any)
    ViewsT = TypeVar("ViewsT")
    RequestT = TypeVar("RequestT")
    ResponseT = TypeVar("ResponseT")
    GoalT = TypeVar("GoalT")
    ResultT = TypeVar("ResultT")
    FeedbackT = TypeVar("FeedbackT")
    FeedbackMessageT = TypeVar("FeedbackMessageT")
    ServiceT_co = TypeVar("ServiceT_co", bound=Service[Any, Any], covariant=True, default=Any)
    ActionT_co = TypeVar("ActionT_co", bound=Action[Any, Any, Any, Any, Any], covariant=True, default=Any)

    class ServiceClass(Protocol[T_co, RequestT, ResponseT]):
        """The class of a service, as a value, with what its requests and responses are."""

        def __parts__(self) -> tuple[T_co, list[RequestT], list[ResponseT]]: ...

    class ActionClass(Protocol[T_co, GoalT, ResultT]):
        """The class of an action, as a value, with what its goals and results are."""

        def __parts__(self) -> tuple[T_co, list[GoalT], list[ResultT]]: ...

    MessageInfo: TypeAlias = dict[str, Any]
    """The second argument of a subscription's callback: `source_timestamp` [ns] and others."""
    MaybeAsync: TypeAlias = T | Coroutine[Any, Any, T]
    """The result of a callback that may be a coroutine function."""
    MessageCallback: TypeAlias = Callable[[T], object]
    InfoCallback: TypeAlias = Callable[[T, MessageInfo], object]
else:
    from types import GenericAlias

    from rclpy.impl import distro

    _PARAMETERS = {"ActionClient": 3, "ActionServer": 3, "_BaseClient": 2, "_BaseService": 2}
    _PARAMETERS |= {"ClientGoalHandle": 3, "ServerGoalHandle": 3}

    class Generic:
        """The base of what newer ROS lets programs write with type arguments."""

        def __class_getitem__(cls, arguments):
            """Return the class with its arguments, which mean nothing at run time."""
            if cls is Generic:  # a base in rclpy itself, with parameters for type checkers
                return cls
            distro.uses("generics")
            arguments = arguments if isinstance(arguments, tuple) else (arguments,)
            expected = next(
                (_PARAMETERS[base.__name__] for base in cls.__mro__ if base.__name__ in _PARAMETERS), 1
            )
            if len(arguments) != expected:
                few = "few" if len(arguments) < expected else "many"
                raise TypeError(
                    f"Too {few} arguments for {cls}; actual {len(arguments)}, expected {expected}"
                )
            return GenericAlias(cls, arguments)

    class PlainBase:
        """Stands for a base whose parameters only type checkers see."""

        def __init__(self, base):
            self._base = base

        def __getitem__(self, parameters):
            """Return the base."""
            return self._base

    T = MessageT = ServiceT_co = ActionT_co = None
