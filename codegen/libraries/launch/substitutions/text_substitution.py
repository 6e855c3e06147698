"""TextSubstitution, by upstream's module name."""

from launch.substitutions._texts import TextSubstitution

__all__ = ["TextSubstitution"]
