"""Tests of what the node speech_recognition does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from array import array
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from humanoid.sensing import voice
from rclpy.parameter import Parameter
from speech_recognition._speech_recognition_base import (
    MICROPHONE_AUDIO_SUBSCRIPTION_QOS,
    SPEECH_TEXT_PUBLISHER_QOS,
    SPEECH_TYPED_SUBSCRIPTION_QOS,
)
from speech_recognition.speech_recognition import SpeechRecognition
from std_msgs.msg import Int16MultiArray, String
from std_srvs.srv import SetBool

BLOCK = voice.RATE // 50  # samples of 20 ms


class Person:
    """Somebody who speaks and types, and reads what was understood."""

    def __init__(self, ros: Any) -> None:
        self._ros = ros
        self.read: list[str] = []
        self.blocks = ros.peer.create_publisher(
            Int16MultiArray, "/microphone/audio", MICROPHONE_AUDIO_SUBSCRIPTION_QOS
        )
        self.lines = ros.peer.create_publisher(String, "/speech/typed", SPEECH_TYPED_SUBSCRIPTION_QOS)
        ros.peer.create_subscription(
            String, "/speech/text", lambda m: self.read.append(m.data), SPEECH_TEXT_PUBLISHER_QOS
        )

    def speak(self, node: SpeechRecognition, sound: np.ndarray) -> None:
        """Send blocks one by one, each after the last one was heard: none may get lost."""
        heard: list[int] = []
        listen = node.on_microphone_audio

        def on_block(message: Int16MultiArray) -> None:
            heard.append(len(message.data))
            listen(message)

        node.on_microphone_audio = on_block  # type: ignore[method-assign]  # to see that it has arrived
        sound = np.concatenate([sound, np.zeros(voice.RATE, dtype=np.int16)])
        for start in range(0, len(sound), BLOCK):
            block = sound[start : start + BLOCK]
            node.on_microphone_audio(Int16MultiArray(data=array("h", block.tobytes())))
        assert heard


def test_spoken_words_become_text(ros: Any) -> None:
    node = ros.start(SpeechRecognition)
    person = Person(ros)
    person.speak(node, voice.say("robot dance wave", pitch=150.0, speed=0.95))
    ros.spin_until(lambda: person.read, "text")
    assert person.read == ["dance wave"]


def test_sound_arrives_by_the_microphone(ros: Any) -> None:
    node = ros.start(SpeechRecognition, Parameter("hot_word", value=""))
    person = Person(ros)
    sound = voice.say("stop")
    block = Int16MultiArray(data=array("h", sound[4000 : 4000 + BLOCK].tobytes()))
    ros.deliver(lambda: person.blocks.publish(block), lambda: node._listener is not None, "a block of sound")


def test_words_for_somebody_else_and_other_sounds_are_left_alone(ros: Any) -> None:
    node = ros.start(SpeechRecognition)
    person = Person(ros)
    noise = np.random.default_rng(0).normal(0, 3000, voice.RATE // 2).astype(np.int16)
    for sound in (voice.say("dance wave"), noise, np.concatenate([voice.say("robot"), noise])):
        person.speak(node, sound)
    answer = ros.call(SetBool, "/speech_recognition/set_listening", SetBool.Request(data=False))
    assert answer.success
    person.speak(node, voice.say("robot stop"))
    assert not ros.spins_until(lambda: person.read, 0.2)


def test_typed_lines_pass_with_or_without_the_hot_word(ros: Any) -> None:
    ros.start(SpeechRecognition)
    person = Person(ros)
    for line, text in (("Robot walk 1 0 0", "walk 1 0 0"), (" stop ", "stop")):
        person.read.clear()
        ros.deliver(
            lambda line=line: person.lines.publish(String(data=line)),
            lambda: person.read,
            f"text for '{line}'",
        )
        assert person.read[-1] == text
