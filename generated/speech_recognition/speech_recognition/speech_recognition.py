"""The node speech_recognition: written once by ifgen, yours from then on.

`ifgen run -m speech_recognition.speech_recognition` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import Int16MultiArray, String
from std_srvs.srv import SetBool

from speech_recognition._speech_recognition_base import SpeechRecognitionBase
from speech_recognition._speech_recognition_parameters import ParametersError


class SpeechRecognition(SpeechRecognitionBase):
    """Turns what the microphone hears into text, one message an utterance."""

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)
        self.publish_speech_text(String())

    def on_microphone_audio(self, message: Int16MultiArray) -> None:
        """Take a message from `/microphone/audio`.

        Blocks of 20 ms of sound, one channel
        """
        self.get_logger().debug("message on /microphone/audio")

    def handle_set_listening(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Answer a request to `~/set_listening`.

        Begin or end listening
        """
        return response


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = SpeechRecognition()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"speech_recognition: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
