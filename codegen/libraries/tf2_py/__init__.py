"""tf2's store of transforms in plain Python: `BufferCore`, and the exceptions of lookups.

The names, signatures and texts are those of ROS 2 Jazzy's `tf2_py`, whose core is in C++.
"""

from tf2_py.buffer_core import BufferCore
from tf2_py.exceptions import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)

__all__ = [
    "BufferCore",
    "ConnectivityException",
    "ExtrapolationException",
    "InvalidArgumentException",
    "LookupException",
    "TimeoutException",
    "TransformException",
]
