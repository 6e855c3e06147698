"""The codec of a message as Python text: two straight-line functions and the constants that they use."""

from ifgen.generator_py.codec.extent import Extents
from ifgen.generator_py.codec.plan import CodecText, plan_codec

__all__ = ["CodecText", "Extents", "plan_codec"]
