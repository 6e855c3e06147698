"""All that the middleware knows of message classes: names, hashes, how to serialise."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, partial
from importlib import import_module
from typing import Any

from ifgen_runtime.codec import deserialize, serialize
from ifgen_runtime.codec.choice import attached, packer
from ifgen_runtime.errors import DeserializationError as DecodeError
from ifgen_runtime.errors import SerializationError
from ifgen_runtime.message import generated_class

from rmw_local.notices import Drops

__all__ = [
    "DecodeError",
    "MessageType",
    "SerializationError",
    "ServiceType",
    "is_message_class",
    "is_service_class",
    "message_type",
    "service_type",
    "service_with_hash",
    "type_name",
]


class MessageType:
    """One message class with the functions that delivery needs.

    `serialize` refuses field values that cannot be sent (SerializationError, which names the field).
    `deserialize` raises DecodeError for bytes that are not such a message; a caller that drops them adds to
    `drops`.
    """

    def __init__(self, cls: type[Any]) -> None:
        if not is_message_class(cls):
            # The attribute that upstream's extension misses first.
            raise AttributeError(f"type object '{cls.__name__}' has no attribute '_TYPE_SUPPORT'")
        self.cls = cls
        self.name = type_name(cls)
        self.serialize: Callable[[Any], bytes]
        self.deserialize: Callable[[bytes], Any]
        self.pack: Callable[[Any], Any]
        """For one reader of this type: bytes, or a parcel in their place, which `deserialize` takes once."""
        if hasattr(cls, "__serialize__"):
            # A generated class has its own functions. They are used directly, which saves one call for each
            # message.
            self.serialize, self.deserialize = attached(generated_class(cls))
            self.pack = packer(generated_class(cls))
        else:
            self.serialize, self.deserialize = serialize, partial(deserialize, cls=cls)
            self.pack = serialize
        self.drops = Drops(self.name)
        self.action: type[Any] | None = None  # that this is a part of

    @cached_property
    def deserialize_views(self) -> Callable[[bytes], Any]:
        """The same as `deserialize`, but sequences of numbers stay in the bytes."""
        from ifgen_runtime.views import decoders  # late: with numpy

        return decoders[self.cls]

    @cached_property
    def type_hash(self) -> str:
        """`RIHS01_...`, empty for a class that does not bring one."""
        return str(getattr(self.cls, "__type_hash__", ""))

    @cached_property
    def type_hash_value(self) -> tuple[int, bytes]:
        """The version and the 32 bytes of the type hash; version 0 if there is none."""
        prefix, _, digits = self.type_hash.partition("_")
        return (int(prefix.removeprefix("RIHS")), bytes.fromhex(digits)) if digits else (0, bytes(32))


class Elsewhere:
    """Stands for the class of an endpoint in another process: only its name and its type hash are known."""


class ServiceType:
    """One service class."""

    def __init__(self, cls: type[Any]) -> None:
        if not is_service_class(cls):
            raise AttributeError(f"type object '{cls.__name__}' has no attribute '_TYPE_SUPPORT'")
        self.cls = cls
        self.name = type_name(cls)
        self.request = message_type(cls.Request)
        self.response = message_type(cls.Response)
        self.action: type[Any] | None = None  # that this is a part of

    @cached_property
    def type_hash(self) -> str:
        """`RIHS01_...`, empty for a class that does not bring one."""
        return str(getattr(self.cls, "__type_hash__", ""))

    @cached_property
    def event(self) -> MessageType:
        """The type of its introspection events."""
        return message_type(self.cls.Event)


_MESSAGES: dict[type[Any], MessageType] = {}
_SERVICES: dict[type[Any], ServiceType] = {}


def message_type(cls: type[Any]) -> MessageType:
    """Return what is known of a message class; looked up once per class."""
    known = _MESSAGES.get(cls)
    if known is None:
        known = _MESSAGES.setdefault(cls, MessageType(cls))
    return known


def service_type(cls: type[Any]) -> ServiceType:
    """Return what is known of a service class; looked up once per class."""
    known = _SERVICES.get(cls)
    if known is None:
        known = _SERVICES.setdefault(cls, ServiceType(cls))
    return known


def service_with_hash(name: str, type_hash: str) -> ServiceType | None:
    """Return a service, or one of an action, if this process can import the definition with this hash."""
    package, kind, short = name.split("/")
    action, _, part = short.rpartition("_") if kind == "action" else (short, "", "")
    try:
        cls = getattr(import_module(f"{package}.{kind}"), action)
        cls = getattr(cls.Impl, f"{part}Service") if part else cls
    except (ImportError, AttributeError):
        return None
    return service_type(cls) if getattr(cls, "__type_hash__", "") == type_hash else None


def is_message_class(cls: object) -> bool:
    """Whether this is the class of a message (or of a part of a service or an action)."""
    return hasattr(cls, "get_fields_and_field_types")


def is_service_class(cls: object) -> bool:
    """Whether this is the class of a service."""
    return getattr(cls, "Request", None) is not None and getattr(cls, "Response", None) is not None


def type_name(cls: type[Any]) -> str:
    """Return `pkg/kind/Name` of a message, service or action class."""
    package, kind, *_ = cls.__module__.split(".")
    return f"{package}/{kind}/{cls.__name__}"
