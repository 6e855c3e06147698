"""Messages of statistics_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from statistics_msgs.msg._metrics_message import MetricsMessage as MetricsMessage
    from statistics_msgs.msg._statistic_data_point import StatisticDataPoint as StatisticDataPoint
    from statistics_msgs.msg._statistic_data_type import StatisticDataType as StatisticDataType

__all__ = [
    "MetricsMessage",
    "StatisticDataPoint",
    "StatisticDataType",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "MetricsMessage": "_metrics_message",
        "StatisticDataPoint": "_statistic_data_point",
        "StatisticDataType": "_statistic_data_type",
    },
)
