"""The exceptions for users: those of the codec and of the conversions, and a server that is gone."""

from __future__ import annotations

TYPE_CHECKING = False  # typing itself takes longer to import than a message package
if TYPE_CHECKING:
    from typing import Any


class CodecError(ValueError):
    """A message and its other form do not fit together: `problem` says how, `path` says where.

    `path` starts with the class of the message: `JointState.position[3]`.
    """

    def __init__(self, path: str, problem: str) -> None:
        super().__init__(path, problem)
        self.path = path
        self.problem = problem

    def __str__(self) -> str:
        return f"{self.path}: {self.problem}"


class SerializationError(CodecError):
    """A field holds what the wire cannot hold: a wrong type, a value out of range, too many elements."""


class TextEncodingError(SerializationError, UnicodeEncodeError):
    """Half of a surrogate pair in a text field: a UnicodeEncodeError, as rosidl's classes raise."""

    def __init__(self, path: str, problem: str, *details: Any) -> None:
        UnicodeEncodeError.__init__(self, *details)
        self.args = (path, problem, *details)
        self.path = path
        self.problem = problem


class DeserializationError(CodecError):
    """The bytes are not a message of this type: truncated, a wrong header, a count beyond a bound."""


class ConversionError(CodecError):
    """A mapping, its JSON or YAML text, or an array holds what a message of this type cannot hold."""


class ServerGoneError(ConnectionError):
    """No response will come to a request: the servers that it was sent to are gone.

    On the local transport, the future of the request holds it. Real rclpy leaves the future pending.
    """


class Problem(Exception):
    """A mistake, on its way up to a caller that knows the path. It never leaves this package."""

    def __init__(self, text: str, failure: UnicodeEncodeError | None = None) -> None:
        super().__init__(text)
        self.text = text
        self.failure = failure
        self.place = ""

    def at(self, place: str) -> Problem:
        """Put a step of the path (`.name` or `[3]`) before those that are known."""
        self.place = place + self.place
        return self

    def named(self, path: str) -> Exception:
        """The error for users, with the path of the message or field that the place is in."""
        return ConversionError(path + self.place, self.text)


class WrongKind(Problem):
    """A value is not of a kind that can be converted. Users get a TypeError."""

    def named(self, path: str) -> Exception:
        """The error for users, with the path of the message or field that the place is in."""
        return TypeError(f"{path}{self.place}: {self.text}")


def printable(text: str) -> str:
    """The text with a question mark in place of all that could control a terminal or end a line."""
    return text if text.isprintable() else "".join(each if each.isprintable() else "?" for each in text)


def printable_lines(text: str) -> str:
    """The same for a text of several lines."""
    return text if text.isprintable() else "\n".join(map(printable, text.split("\n")))
