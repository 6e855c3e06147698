"""The parts of numpy that this package needs, or one sentence where there is none."""

try:
    import numpy
    from numpy.lib.recfunctions import structured_to_unstructured, unstructured_to_structured
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(
        "sensor_msgs_py needs numpy: run `python -m pip install numpy`", name=error.name
    ) from None

__all__ = ["numpy", "structured_to_unstructured", "unstructured_to_structured"]
