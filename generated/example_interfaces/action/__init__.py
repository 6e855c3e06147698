"""Actions of example_interfaces.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from example_interfaces.action._fibonacci import Fibonacci as Fibonacci
    from example_interfaces.action._fibonacci import Fibonacci_GetResult_Event as Fibonacci_GetResult_Event
    from example_interfaces.action._fibonacci import (
        Fibonacci_GetResult_Request as Fibonacci_GetResult_Request,
    )
    from example_interfaces.action._fibonacci import (
        Fibonacci_GetResult_Response as Fibonacci_GetResult_Response,
    )
    from example_interfaces.action._fibonacci import Fibonacci_SendGoal_Event as Fibonacci_SendGoal_Event
    from example_interfaces.action._fibonacci import Fibonacci_SendGoal_Request as Fibonacci_SendGoal_Request
    from example_interfaces.action._fibonacci import (
        Fibonacci_SendGoal_Response as Fibonacci_SendGoal_Response,
    )

__all__ = [
    "Fibonacci",
    "Fibonacci_GetResult_Event",
    "Fibonacci_GetResult_Request",
    "Fibonacci_GetResult_Response",
    "Fibonacci_SendGoal_Event",
    "Fibonacci_SendGoal_Request",
    "Fibonacci_SendGoal_Response",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Fibonacci": "_fibonacci",
        "Fibonacci_GetResult_Event": "_fibonacci",
        "Fibonacci_GetResult_Request": "_fibonacci",
        "Fibonacci_GetResult_Response": "_fibonacci",
        "Fibonacci_SendGoal_Event": "_fibonacci",
        "Fibonacci_SendGoal_Request": "_fibonacci",
        "Fibonacci_SendGoal_Response": "_fibonacci",
    },
)
