"""The node camera_driver: triggers the head camera's sensor, and publishes what it delivers as images."""

from __future__ import annotations

from typing import Any

from humanoid.ros import images, messages
from humanoid.ros.diagnostics import Health
from humanoid.ros.running import run
from humanoid.sensing.camera import lens_of, resized
from rclpy.lifecycle import LifecycleState, TransitionCallbackReturn
from sensor_msgs.msg import Image
from std_msgs.msg import Empty
from std_srvs.srv import SetBool

from camera_driver._camera_driver_base import CameraDriverBase
from camera_driver._camera_driver_parameters import CameraDriverParameters, ParametersError

_LOST = "the sensor has not delivered a picture since the last trigger"


class CameraDriver(CameraDriverBase):
    """Triggers a picture each period while it streams. It counts those that do not come."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._streaming = self.parameters.streaming
        self._waits = False  # for the picture of the last trigger
        self._health = Health("camera_driver: sensor", self.get_logger(), "pictures", "drop-outs")

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Begin anew: what was triggered before nobody waits for."""
        self._waits = False
        return super().on_activate(state)

    def on_parameters_changed(self, parameters: CameraDriverParameters) -> None:
        """Start or stop capturing."""
        self._streaming = parameters.streaming

    def handle_set_streaming(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Start or stop capturing."""
        self._streaming, self._waits = request.data, False
        response.success = True
        return response

    def on_capture_timer(self) -> None:
        """Trigger the next picture, and notice if the last one has not come."""
        if not self._streaming:
            return
        self._health.takes("drop-outs", _LOST if self._waits else "")
        self._waits = True
        self.publish_head_camera_trigger(Empty())

    def on_head_camera_sensor(self, message: Image) -> None:
        """Publish a picture as an image, with its calibration."""
        if not self._streaming:
            return
        self._waits = False
        size = self.parameters.image
        try:
            picture = resized(images.read_image(message), size.width, size.height)
        except ValueError as error:
            self._health.takes("pictures", f"/head_camera/sensor: {error}")
            return
        header = messages.header(messages.nanoseconds(message.header.stamp), self.parameters.frame_id)
        lens = lens_of(size.width, size.height, self.parameters.fovy)
        self.publish_head_camera_camera_info(images.camera_info(header, lens))
        self.publish_head_camera_image_raw(images.image(header, picture, size.encoding))

    def on_diagnostics_timer(self) -> None:
        """Report what did not come, or was refused."""
        self.publish_diagnostics(self._health.report(self.get_clock().now().nanoseconds))


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(CameraDriver, args, ParametersError)


if __name__ == "__main__":
    main()
