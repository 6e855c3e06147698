from collections.abc import Callable
from types import CapsuleType
from typing import Any

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
    program: bytes,
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
def accepts(program: bytes, payload: bytes, /) -> bool: ...
