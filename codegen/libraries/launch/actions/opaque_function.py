"""OpaqueFunction, by upstream's module name."""

from launch.actions._groups import OpaqueFunction

__all__ = ["OpaqueFunction"]
