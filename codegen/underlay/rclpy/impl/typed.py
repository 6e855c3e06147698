"""What type checkers know of rclpy beyond what there is at run time.

Upstream's classes are not generic in Jazzy: evaluating `Publisher[Point]` raises TypeError. Here it does too,
so what runs on ours runs on the real one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine
    from typing import Any, Protocol, TypeAlias
    from typing import Generic as Generic  # noqa: PLC0414 - modules import it from here

    from ifgen_runtime.interface import Action as Action  # noqa: PLC0414 - modules import it from here
    from ifgen_runtime.interface import Service as Service  # noqa: PLC0414 - modules import it from here
    from typing_extensions import TypeVar  # checkers know it without its being installed

    # Those of classes have defaults: `Future` alone stands for `Future[Any]`, as programs have written it.
    T = TypeVar("T", default=Any)
    T_co = TypeVar("T_co", covariant=True)
    MessageT = TypeVar("MessageT", default=Any)
    RequestT = TypeVar("RequestT")
    RequestT_co = TypeVar("RequestT_co", covariant=True)
    ResponseT = TypeVar("ResponseT")
    ResponseT_co = TypeVar("ResponseT_co", covariant=True)
    GoalT = TypeVar("GoalT")
    GoalT_co = TypeVar("GoalT_co", covariant=True)
    ResultT = TypeVar("ResultT")
    ResultT_co = TypeVar("ResultT_co", covariant=True)
    FeedbackT = TypeVar("FeedbackT")
    FeedbackT_co = TypeVar("FeedbackT_co", covariant=True)
    FeedbackMessageT = TypeVar("FeedbackMessageT")
    ServiceT_co = TypeVar("ServiceT_co", bound=Service[Any, Any], covariant=True, default=Any)
    ActionT_co = TypeVar("ActionT_co", bound=Action[Any, Any, Any, Any, Any], covariant=True, default=Any)

    class ServiceClass(Protocol[T_co, RequestT_co, ResponseT_co]):
        """The class of a service, as a value, with what its requests and responses are."""

        def __parts__(self) -> tuple[T_co, RequestT_co, ResponseT_co]: ...

    class ActionClass(Protocol[T_co, GoalT_co, ResultT_co, FeedbackT_co]):
        """The class of an action, as a value, with what its goals, results and feedback are."""

        def __parts__(self) -> tuple[T_co, GoalT_co, ResultT_co, FeedbackT_co]: ...

    AnyAction: TypeAlias = Action[Any, Any, Any, Any, Any]
    MessageInfo: TypeAlias = dict[str, Any]
    """What a subscription's callback gets beside the message: `source_timestamp` [ns] and others."""
    MaybeAsync: TypeAlias = T | Coroutine[Any, Any, T]
    """What a callback returns that may be a coroutine function."""
    MessageCallback: TypeAlias = Callable[[MessageT], object]
    InfoCallback: TypeAlias = Callable[[MessageT, MessageInfo], object]
else:

    class PlainBase:
        """Stands for a base whose parameters only type checkers see."""

        def __init__(self, base):
            self._base = base

        def __getitem__(self, parameters):
            """Return the base."""
            return self._base

    Generic = PlainBase(object)
    T = MessageT = ServiceT_co = ActionT_co = None
