"""The imports of generated message packages, and the functions for their messages.

Names are loaded when they are first used, so that importing a message package stays cheap.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from ifgen_runtime.checks import InvalidArgumentsError as InvalidArgumentsError
    from ifgen_runtime.codec import deserialize as deserialize
    from ifgen_runtime.codec import serialize as serialize
    from ifgen_runtime.convert import from_dict as from_dict
    from ifgen_runtime.convert import from_json as from_json
    from ifgen_runtime.convert import from_yaml as from_yaml
    from ifgen_runtime.convert import to_dict as to_dict
    from ifgen_runtime.convert import to_json as to_json
    from ifgen_runtime.convert import to_yaml as to_yaml
    from ifgen_runtime.errors import CodecError as CodecError
    from ifgen_runtime.errors import ConversionError as ConversionError
    from ifgen_runtime.errors import DeserializationError as DeserializationError
    from ifgen_runtime.errors import SerializationError as SerializationError
    from ifgen_runtime.errors import ServerGoneError as ServerGoneError
    from ifgen_runtime.errors import TextEncodingError as TextEncodingError
    from ifgen_runtime.interface import Action as Action
    from ifgen_runtime.interface import Service as Service
    from ifgen_runtime.message import Message as Message

__all__ = [
    "Action",
    "CodecError",
    "ConversionError",
    "DeserializationError",
    "InvalidArgumentsError",
    "Message",
    "SerializationError",
    "ServerGoneError",
    "Service",
    "TextEncodingError",
    "deserialize",
    "from_dict",
    "from_json",
    "from_yaml",
    "serialize",
    "to_dict",
    "to_json",
    "to_yaml",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Action": "interface",
        "CodecError": "errors",
        "ConversionError": "errors",
        "DeserializationError": "errors",
        "InvalidArgumentsError": "checks",
        "Message": "message",
        "SerializationError": "errors",
        "ServerGoneError": "errors",
        "Service": "interface",
        "TextEncodingError": "errors",
        "deserialize": "codec",
        "from_dict": "convert",
        "from_json": "convert",
        "from_yaml": "convert",
        "serialize": "codec",
        "to_dict": "convert",
        "to_json": "convert",
        "to_yaml": "convert",
    },
)
