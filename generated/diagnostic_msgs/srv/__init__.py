"""Services of diagnostic_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from diagnostic_msgs.srv._add_diagnostics import AddDiagnostics as AddDiagnostics
    from diagnostic_msgs.srv._add_diagnostics import AddDiagnostics_Event as AddDiagnostics_Event
    from diagnostic_msgs.srv._add_diagnostics import AddDiagnostics_Request as AddDiagnostics_Request
    from diagnostic_msgs.srv._add_diagnostics import AddDiagnostics_Response as AddDiagnostics_Response
    from diagnostic_msgs.srv._self_test import SelfTest as SelfTest
    from diagnostic_msgs.srv._self_test import SelfTest_Event as SelfTest_Event
    from diagnostic_msgs.srv._self_test import SelfTest_Request as SelfTest_Request
    from diagnostic_msgs.srv._self_test import SelfTest_Response as SelfTest_Response

__all__ = [
    "AddDiagnostics",
    "AddDiagnostics_Event",
    "AddDiagnostics_Request",
    "AddDiagnostics_Response",
    "SelfTest",
    "SelfTest_Event",
    "SelfTest_Request",
    "SelfTest_Response",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "AddDiagnostics": "_add_diagnostics",
        "AddDiagnostics_Event": "_add_diagnostics",
        "AddDiagnostics_Request": "_add_diagnostics",
        "AddDiagnostics_Response": "_add_diagnostics",
        "SelfTest": "_self_test",
        "SelfTest_Event": "_self_test",
        "SelfTest_Request": "_self_test",
        "SelfTest_Response": "_self_test",
    },
)
