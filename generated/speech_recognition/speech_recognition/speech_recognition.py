"""The node speech_recognition: spots words in the sound of the microphone, and takes typed lines."""

from __future__ import annotations

from typing import Any

import numpy as np
from humanoid.ros.running import run
from humanoid.sensing import voice
from humanoid.sensing.hearing import Listener, understood
from std_msgs.msg import Int16MultiArray, String
from std_srvs.srv import SetBool

from speech_recognition._speech_recognition_base import SpeechRecognitionBase
from speech_recognition._speech_recognition_parameters import ParametersError


class SpeechRecognition(SpeechRecognitionBase):
    """Collects blocks of sound to utterances, and passes on those that begin with the hot word."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._listening = True
        self._listener: Listener | None = None  # its patterns take time, and often nobody speaks

    def on_microphone_audio(self, message: Int16MultiArray) -> None:
        """Listen to a block of sound."""
        if not self._listening:
            return
        if self._listener is None:
            self._listener = Listener(silence=self.parameters.silence_time)
        block = np.array(message.data, dtype=np.int16)
        share = self.parameters.sample_rate // voice.RATE
        if share > 1:
            whole = block[: len(block) // share * share].reshape(-1, share)
            block = whole.mean(axis=1).astype(np.int16)
        heard = self._listener.hear(block)
        if heard is None:
            return
        words = understood(heard, self.parameters.hot_word)
        if words:
            self.publish_speech_text(String(data=words))
        else:
            self.get_logger().info(f"heard '{heard}', which is not for me")

    def on_speech_typed(self, message: String) -> None:
        """Pass on a line that somebody typed; the hot word is not needed."""
        words = message.data.strip().lower()
        words = understood(words, self.parameters.hot_word) or understood(words)
        if words:
            self.publish_speech_text(String(data=words))

    def handle_set_listening(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Begin or end listening to the microphone."""
        self._listening = request.data
        if self._listener is not None:
            self._listener.forget()
        response.success = True
        return response


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(SpeechRecognition, args, ParametersError)


if __name__ == "__main__":
    main()
