"""The parts of numpy that this package needs, or one sentence where there is none."""

from importlib.util import find_spec

if find_spec("numpy") is None:
    raise ModuleNotFoundError("sensor_msgs_py needs numpy: run `python -m pip install numpy`", name="numpy")

import numpy
from numpy.lib.recfunctions import (
    structured_to_unstructured,
    unstructured_to_structured,
)

__all__ = ["numpy", "structured_to_unstructured", "unstructured_to_structured"]
