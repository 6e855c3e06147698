"""What the classes of all interfaces have in common, and the bases of service and action classes."""

from __future__ import annotations

TYPE_CHECKING = False  # typing itself takes longer to import than a message package
if TYPE_CHECKING:
    from typing import Any, ClassVar


class InterfaceMeta(type):
    """The metaclass of generated interface classes: it carries the type support that real rclpy asks for.

    Every generated class has a metaclass of its own, derived from this one, as rosidl's have: the attributes
    are those of one type, and None until `__import_type_support__` sets them.
    """

    _TYPE_SUPPORT: Any = None
    _interface: ClassVar[type]

    @classmethod
    def __import_type_support__(mcs) -> None:
        """Set the type support of the class and of its parts; raises TypeSupportError where there is none."""
        from ifgen_runtime.type_support import import_type_support  # only real rclpy comes here

        import_type_support(mcs._interface)


class ServiceMeta(InterfaceMeta):
    """The metaclass of services and actions, which are never instantiated."""

    def __new__(mcs, name: str, bases: tuple[type, ...], namespace: dict[str, Any]) -> ServiceMeta:
        """Remember the generated class; classes derived from it share its type support."""
        cls = super().__new__(mcs, name, bases, namespace)
        if "__type_hash__" in namespace:
            mcs._interface = cls
        return cls


class Service(metaclass=ServiceMeta):
    """The base of service classes, which only hold other classes: `Request`, `Response` and `Event`."""

    __type_hash__: ClassVar[str]


class Action(metaclass=ServiceMeta):
    """The base of action classes, which only hold other classes: `Goal`, `Result`, `Feedback` and `Impl`."""

    __type_hash__: ClassVar[str]
