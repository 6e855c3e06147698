"""Messages of example_interfaces.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from example_interfaces.msg._bool import Bool as Bool
    from example_interfaces.msg._byte import Byte as Byte
    from example_interfaces.msg._byte_multi_array import ByteMultiArray as ByteMultiArray
    from example_interfaces.msg._char import Char as Char
    from example_interfaces.msg._empty import Empty as Empty
    from example_interfaces.msg._float32 import Float32 as Float32
    from example_interfaces.msg._float32_multi_array import Float32MultiArray as Float32MultiArray
    from example_interfaces.msg._float64 import Float64 as Float64
    from example_interfaces.msg._float64_multi_array import Float64MultiArray as Float64MultiArray
    from example_interfaces.msg._int8 import Int8 as Int8
    from example_interfaces.msg._int8_multi_array import Int8MultiArray as Int8MultiArray
    from example_interfaces.msg._int16 import Int16 as Int16
    from example_interfaces.msg._int16_multi_array import Int16MultiArray as Int16MultiArray
    from example_interfaces.msg._int32 import Int32 as Int32
    from example_interfaces.msg._int32_multi_array import Int32MultiArray as Int32MultiArray
    from example_interfaces.msg._int64 import Int64 as Int64
    from example_interfaces.msg._int64_multi_array import Int64MultiArray as Int64MultiArray
    from example_interfaces.msg._multi_array_dimension import MultiArrayDimension as MultiArrayDimension
    from example_interfaces.msg._multi_array_layout import MultiArrayLayout as MultiArrayLayout
    from example_interfaces.msg._string import String as String
    from example_interfaces.msg._u_int8 import UInt8 as UInt8
    from example_interfaces.msg._u_int8_multi_array import UInt8MultiArray as UInt8MultiArray
    from example_interfaces.msg._u_int16 import UInt16 as UInt16
    from example_interfaces.msg._u_int16_multi_array import UInt16MultiArray as UInt16MultiArray
    from example_interfaces.msg._u_int32 import UInt32 as UInt32
    from example_interfaces.msg._u_int32_multi_array import UInt32MultiArray as UInt32MultiArray
    from example_interfaces.msg._u_int64 import UInt64 as UInt64
    from example_interfaces.msg._u_int64_multi_array import UInt64MultiArray as UInt64MultiArray
    from example_interfaces.msg._w_string import WString as WString

__all__ = [
    "Bool",
    "Byte",
    "ByteMultiArray",
    "Char",
    "Empty",
    "Float32",
    "Float32MultiArray",
    "Float64",
    "Float64MultiArray",
    "Int8",
    "Int8MultiArray",
    "Int16",
    "Int16MultiArray",
    "Int32",
    "Int32MultiArray",
    "Int64",
    "Int64MultiArray",
    "MultiArrayDimension",
    "MultiArrayLayout",
    "String",
    "UInt8",
    "UInt8MultiArray",
    "UInt16",
    "UInt16MultiArray",
    "UInt32",
    "UInt32MultiArray",
    "UInt64",
    "UInt64MultiArray",
    "WString",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Bool": "_bool",
        "Byte": "_byte",
        "ByteMultiArray": "_byte_multi_array",
        "Char": "_char",
        "Empty": "_empty",
        "Float32": "_float32",
        "Float32MultiArray": "_float32_multi_array",
        "Float64": "_float64",
        "Float64MultiArray": "_float64_multi_array",
        "Int16": "_int16",
        "Int16MultiArray": "_int16_multi_array",
        "Int32": "_int32",
        "Int32MultiArray": "_int32_multi_array",
        "Int64": "_int64",
        "Int64MultiArray": "_int64_multi_array",
        "Int8": "_int8",
        "Int8MultiArray": "_int8_multi_array",
        "MultiArrayDimension": "_multi_array_dimension",
        "MultiArrayLayout": "_multi_array_layout",
        "String": "_string",
        "UInt16": "_u_int16",
        "UInt16MultiArray": "_u_int16_multi_array",
        "UInt32": "_u_int32",
        "UInt32MultiArray": "_u_int32_multi_array",
        "UInt64": "_u_int64",
        "UInt64MultiArray": "_u_int64_multi_array",
        "UInt8": "_u_int8",
        "UInt8MultiArray": "_u_int8_multi_array",
        "WString": "_w_string",
    },
)
