"""The codec of a message: its program, and the renderings of the program.

`plan` turns a message into a program. `render` turns the program into Python text: two straight-line
functions, and the constants that they use.
"""

from ifgen.generator_py.codec.extent import Extents
from ifgen.generator_py.codec.plan import plan
from ifgen.generator_py.codec.python.text import CodecText, render

__all__ = ["CodecText", "Extents", "plan", "render"]
