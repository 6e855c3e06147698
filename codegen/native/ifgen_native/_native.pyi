from array import array
from collections.abc import Callable, Iterable
from types import CapsuleType
from typing import Any, final

from typing_extensions import Buffer

TYPE_SUPPORT_VERSION: int

@final
class Parcel:
    def __bytes__(self) -> bytes: ...

def crc32(data: Buffer, value: int = 0, /) -> int: ...  # where the processor can
def bind(symbols: dict[str, int], /) -> None: ...
def introspection(members: int, /) -> int: ...
def message(
    namespace: str,
    name: str,
    introspection: int,
    hash: int,
    description: int,
    sources: int,
    encode: Callable[[Any], bytes],
    decode: Callable[[bytes], Any],
    layout: tuple[tuple[str, bytes], ...],
    /,
) -> tuple[int, tuple[CapsuleType, CapsuleType, CapsuleType, CapsuleType, CapsuleType]]: ...
def service(
    namespace: str,
    name: str,
    request: int,
    response: int,
    event: int,
    make_event: Callable[..., Any],
    hash: int,
    description: int,
    sources: int,
    /,
) -> tuple[int, CapsuleType]: ...
def action(
    goal: int,
    result: int,
    cancel: int,
    feedback: int,
    status: int,
    hash: int,
    description: int,
    sources: int,
    /,
) -> CapsuleType: ...
def accepts(layout: tuple[tuple[str, bytes], ...], payload: bytes, /) -> bool: ...
def serialize(message: Any) -> bytes: ...
def deserialize(data: Any, cls: type[Any]) -> Any: ...
def codec_open(
    abi: int,
    serialize: Callable[[Any], bytes],
    deserialize: Callable[[Any, type[Any]], Any],
    encode_derived: Callable[[Any], bytes],
    /,
) -> str | None: ...
def codec_attach(
    cls: type[Any],
    encode: Callable[[Any], bytes],
    decode: Callable[[bytes], Any],
    rows: str,
    classes: tuple[type[Any], ...],
    /,
) -> tuple[Callable[[Any], bytes], Callable[[bytes], Any]]: ...
def codec_methods(
    cls: type[Any], /
) -> tuple[Callable[[Any, object], bool], Callable[[Any, dict[int, Any]], Any], Callable[[Any], Any]]: ...
def codec_array(typecode: str, values: Iterable[Any], /) -> array[Any]: ...
def codec_packer(cls: type[Any], /) -> Callable[[Any], Parcel | bytes]: ...
def codec_large_in_parcels(size: int, /) -> int: ...
def codec_counts() -> tuple[int, int, int]: ...
