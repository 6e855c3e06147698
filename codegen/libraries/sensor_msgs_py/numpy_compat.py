"""Two functions of numpy, under the name that programs for old versions of numpy import them from."""

from sensor_msgs_py._numpy import structured_to_unstructured, unstructured_to_structured

__all__ = ["structured_to_unstructured", "unstructured_to_structured"]
