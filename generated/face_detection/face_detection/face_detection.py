"""The node face_detection: finds faces in the images of the head camera."""

from __future__ import annotations

import math
from typing import Any

from geometry_msgs.msg import Pose, Vector3
from humanoid.ros import messages
from humanoid.ros.images import read_image
from humanoid.ros.running import run
from humanoid.sensing.face_detection import LABEL, Detection, detect
from humanoid_interfaces.msg import DetectedObject, DetectedObjectArray
from humanoid_interfaces.srv import DetectObjects
from sensor_msgs.msg import CameraInfo, Image, RegionOfInterest
from std_msgs.msg import Header

from face_detection._face_detection_base import FaceDetectionBase
from face_detection._face_detection_parameters import ParametersError


class FaceDetection(FaceDetectionBase):
    """Examines every image as it arrives."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._fovy = 0.0  # degrees; not known before a calibration arrives
        self._latest: DetectedObjectArray | None = None

    def on_head_camera_camera_info(self, message: CameraInfo) -> None:
        """Take the field of view."""
        if message.k[4] > 0:
            self._fovy = math.degrees(2 * math.atan2(message.height / 2, message.k[4]))

    def on_head_camera_image_raw(self, message: Image) -> None:
        """Look for faces."""
        if not self._fovy or LABEL not in self.parameters.labels:
            return
        try:
            picture = read_image(message)
        except ValueError as error:
            self.get_logger().warning(str(error), throttle_duration_sec=5.0)
            return
        found = [d for d in detect(picture, self._fovy) if d.confidence >= self.parameters.min_confidence]
        objects = [_object(detection) for detection in found[: self.parameters.max_detections]]
        self._latest = DetectedObjectArray(header=message.header, objects=objects)
        self.publish_face_detection_detections(self._latest)

    def handle_detect(
        self, request: DetectObjects.Request, response: DetectObjects.Response
    ) -> DetectObjects.Response:
        """Report what the latest image shows."""
        unknown = [label for label in request.labels if label != LABEL]
        latest = self._latest
        if unknown:
            response.status = DetectObjects.Response.STATUS_UNKNOWN_LABEL
            response.message = f"I know '{LABEL}', not '{unknown[0]}'"
        elif latest is None or self._is_old(latest.header, messages.nanoseconds(request.max_age)):
            response.status = DetectObjects.Response.STATUS_NO_IMAGE
            response.message = "there is no image" if latest is None else "the latest image is too old"
        else:
            objects = [o for o in latest.objects if o.confidence >= request.min_confidence]
            if request.max_objects:
                objects = objects[: request.max_objects]
            response.status = DetectObjects.Response.STATUS_DONE
            response.detections = DetectedObjectArray(header=latest.header, objects=objects)
        return response

    def _is_old(self, header: Header, max_age: int) -> bool:
        age = self.get_clock().now().nanoseconds - messages.nanoseconds(header.stamp)
        return bool(max_age and age > max_age)


def _object(detection: Detection) -> DetectedObject:
    left, top, width, height = detection.region
    x, y, z = detection.position
    return DetectedObject(
        label=detection.label,
        confidence=detection.confidence,
        region=RegionOfInterest(
            x_offset=max(left, 0), y_offset=max(top, 0), width=width, height=height, do_rectify=False
        ),
        has_pose=True,
        pose=Pose(position=messages.point(x, y, z)),
        size=Vector3(x=detection.size, y=detection.size),
    )


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(FaceDetection, args, ParametersError)


if __name__ == "__main__":
    main()
