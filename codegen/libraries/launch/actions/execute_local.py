"""ExecuteLocal, by upstream's module name."""

from launch.actions.execute_process import ExecuteLocal

__all__ = ["ExecuteLocal"]
