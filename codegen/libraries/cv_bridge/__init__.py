"""Images of `sensor_msgs` as numpy arrays, and back, as OpenCV takes them."""

from cv_bridge.core import CvBridge, CvBridgeError

__all__ = ["CvBridge", "CvBridgeError"]
