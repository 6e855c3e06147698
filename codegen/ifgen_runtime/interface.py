"""The common part of all interface classes, and the bases of service and action classes."""

from __future__ import annotations

TYPE_CHECKING = False  # typing itself takes longer to import than a message package
if TYPE_CHECKING:
    from collections.abc import Collection
    from typing import Any, ClassVar, Generic, Protocol, Self, TypeVar

    RequestT = TypeVar("RequestT")
    ResponseT = TypeVar("ResponseT")
    GoalT = TypeVar("GoalT")
    ResultT = TypeVar("ResultT")
    FeedbackT = TypeVar("FeedbackT")
    FeedbackMessageT_co = TypeVar("FeedbackMessageT_co", covariant=True)
    ViewsT_co = TypeVar("ViewsT_co", covariant=True)
    GetResultT_co = TypeVar("GetResultT_co", covariant=True)


class InterfaceMeta(type):
    """The metaclass of generated interface classes: it carries the type support that real rclpy asks for.

    Every generated class has its own metaclass, derived from this one, as with rosidl. The attributes belong
    to one type, and are None until `__import_type_support__` sets them.
    """

    _TYPE_SUPPORT: Any = None
    _interface: ClassVar[type]

    @classmethod
    def __import_type_support__(mcs) -> None:
        """Set the type support of the class and of its parts; raises TypeSupportError where there is none."""
        from ifgen_runtime.real_rclpy import import_type_support  # only real rclpy comes here

        import_type_support(mcs._interface)


def keep_annotations(namespace: dict[str, Any], names: Collection[str]) -> None:
    """Drop the other annotations. Type checkers alone know their names; `get_type_hints` would raise.

    A class without annotations would show those of its metaclass.
    """
    annotations: dict[str, str] = namespace.get("__annotations__", {})
    namespace["__annotations__"] = {name: annotations[name] for name in names if name in annotations}


class ServiceMeta(InterfaceMeta):
    """The metaclass of services and actions, which are never instantiated."""

    def __new__(mcs, name: str, bases: tuple[type, ...], namespace: dict[str, Any]) -> ServiceMeta:
        """Remember the generated class; classes derived from it share its type support."""
        generated = "__type_hash__" in namespace
        if generated or not bases:
            keep_annotations(namespace, ())
        if "Impl" in namespace:
            namespace["Impl"].__annotations__ = {}
        cls = super().__new__(mcs, name, bases, namespace)
        if generated:
            mcs._interface = cls
        return cls


# Type checkers find the parts of a service or an action through the base of its class. Through `__parts__`,
# a method that only they see, they get the class and its parts from one argument. It returns lists because
# these are invariant: a callback that returns something else does not widen the type of a part.
if TYPE_CHECKING:

    class HasViews(Protocol[ViewsT_co]):
        """A message class, as a value, that holds sequences of numbers."""

        def __views__(self) -> ViewsT_co: ...

    class Service(Generic[RequestT, ResponseT], metaclass=ServiceMeta):
        """A service class as type checkers see it: its parts."""

        Request: type[RequestT]
        Response: type[ResponseT]

        @classmethod
        def __parts__(cls) -> tuple[Self, list[RequestT], list[ResponseT]]:
            raise NotImplementedError

    class Action(
        Generic[GoalT, ResultT, FeedbackT, FeedbackMessageT_co, GetResultT_co], metaclass=ServiceMeta
    ):
        """An action class as type checkers see it: its parts, and the parts of `Impl` that users see."""

        Goal: type[GoalT]
        Result: type[ResultT]
        Feedback: type[FeedbackT]

        @classmethod
        def __parts__(cls) -> tuple[Self, list[GoalT], list[ResultT]]:
            raise NotImplementedError

else:

    class Service(metaclass=ServiceMeta):
        """The base of service classes, which only hold classes: `Request`, `Response` and `Event`."""

        def __class_getitem__(cls, parts):
            return cls

    class Action(metaclass=ServiceMeta):
        """The base of action classes, which only hold classes: `Goal`, `Result`, `Feedback` and `Impl`."""

        def __class_getitem__(cls, parts):
            return cls
