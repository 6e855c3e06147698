"""PythonExpression, by upstream's module name."""

from launch.substitutions._expressions import PythonExpression

__all__ = ["PythonExpression"]
