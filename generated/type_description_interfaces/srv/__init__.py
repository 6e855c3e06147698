"""Services of type_description_interfaces.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from type_description_interfaces.srv._get_type_description import GetTypeDescription as GetTypeDescription
    from type_description_interfaces.srv._get_type_description import (
        GetTypeDescription_Event as GetTypeDescription_Event,
    )
    from type_description_interfaces.srv._get_type_description import (
        GetTypeDescription_Request as GetTypeDescription_Request,
    )
    from type_description_interfaces.srv._get_type_description import (
        GetTypeDescription_Response as GetTypeDescription_Response,
    )

__all__ = [
    "GetTypeDescription",
    "GetTypeDescription_Event",
    "GetTypeDescription_Request",
    "GetTypeDescription_Response",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "GetTypeDescription": "_get_type_description",
        "GetTypeDescription_Event": "_get_type_description",
        "GetTypeDescription_Request": "_get_type_description",
        "GetTypeDescription_Response": "_get_type_description",
    },
)
