"""The hash of a type's description."""

from __future__ import annotations


class TypeHash:
    """A type hash: the version of the algorithm and 32 bytes. Prints as `RIHS01_...`, or INVALID."""

    _TYPE_HASH_SIZE = 32

    __slots__ = ["_value", "_version"]

    def __init__(self, version: int = -1, value: bytes = bytes(_TYPE_HASH_SIZE)) -> None:
        self.version = version
        self.value = value

    @property
    def version(self) -> int:
        """The version of the algorithm; anything below 1 is invalid."""
        return self._version

    @version.setter
    def version(self, value: int) -> None:
        """Set it. Raises AssertionError for what is no integer."""
        assert isinstance(value, int)
        self._version = value

    @property
    def value(self) -> bytes:
        """The 32 bytes."""
        return self._value

    @value.setter
    def value(self, value: bytes) -> None:
        """Set it. Raises AssertionError for what is no bytes."""
        assert isinstance(value, bytes)
        self._value = value

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TypeHash) and (self._version, self._value) == (other._version, other._value)

    __hash__ = None  # type: ignore[assignment]  # it can be changed

    def __str__(self) -> str:
        if self._version <= 0 or len(self._value) != self._TYPE_HASH_SIZE:
            return "INVALID"
        return f"RIHS{self._version:02}_{self._value.hex()}"
