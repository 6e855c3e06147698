"""Recordings of what the nodes of a test publish: one that fails leaves its bag and says where."""

from __future__ import annotations

import importlib
import re
import shutil
from collections.abc import Callable, Generator
from contextlib import contextmanager
from importlib.util import find_spec
from os import PathLike
from pathlib import Path
from threading import RLock
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from ifgen_runtime.bag import Recorder

from ifgen_pytest.comparison import counted

if TYPE_CHECKING:
    import pytest

_NOT_IN_NAMES = re.compile(r"[^\w.-]+")

Heard = Callable[[str, Any, Any, int], None]
"""Takes the full topic, the publisher, the message or its bytes, and the time [ns since 1970]."""


@contextmanager
def publications(heard: Heard) -> Generator[None]:
    """Call a function for each message that a publisher sends while the block runs, subscribed to or not.

    There is no subscription that could miss what a constructor publishes, and nothing to match or to spin.
    What rclpy sends by itself is not heard: /rosout, and the hidden topics of actions and services.
    """
    publisher_class = importlib.import_module("rclpy.publisher").Publisher  # that of the chosen transport
    clock = importlib.import_module("rclpy.clock").Clock()
    publish = publisher_class.publish
    topics: WeakKeyDictionary[Any, str] = WeakKeyDictionary()

    def publish_and_tell(publisher: Any, message: Any) -> None:
        now = clock.now().nanoseconds  # before: another thread may answer at once
        publish(publisher, message)
        topic = topics.get(publisher)
        if topic is None:
            topic = topics[publisher] = publisher.topic_name
        heard(topic, publisher, message, now)

    publisher_class.publish = publish_and_tell
    try:
        yield
    finally:
        publisher_class.publish = publish


class Recording:
    """A bag of what the nodes of this process publish. It is deleted once the test has passed."""

    def __init__(self, path: Path) -> None:
        self.path = path
        """The file. It is complete after `end`."""
        self._recorder = Recorder(
            path, compression="zstd" if find_spec("zstandard") else "none", overwrite=True
        )
        self._topics: set[str] = set()
        self._adding = RLock()  # a finaliser may publish meanwhile
        self._refused: dict[str, str] = {}
        self._has_failed = False

    @contextmanager
    def running(self) -> Generator[Recording]:
        """Record while the block runs."""
        with publications(self._write):
            yield self
        self.end()

    def end(self) -> Path:
        """Record no more; returns the path of the bag."""
        self._recorder.close()
        return self.path

    def save(self, path: str | PathLike[str]) -> Path:
        """Record no more, and keep a copy under this path, for a later `replay`; returns that path."""
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        return Path(shutil.copyfile(self.end(), path))

    def note(self, report: pytest.TestReport) -> None:
        """Say where the bag is if this part of the test has failed. Delete it in the end if none has."""
        if report.failed:
            self._has_failed = True
            report.sections.append(("recorded", self._told()))
        if report.when == "teardown" and not self._has_failed:
            self.end()
            self.path.unlink(missing_ok=True)

    def _write(self, topic: str, publisher: Any, message: Any, now: int) -> None:
        """Record a message. A recording that is over, or cannot have it, is no reason to fail in a node."""
        try:
            # The topic comes first, with its QoS: a message of another thread would add it without.
            with self._adding:
                if topic not in self._topics:
                    self._recorder.add_topic(topic, publisher.msg_type, publisher.qos_profile)
                    self._topics.add(topic)
            if isinstance(message, bytes):
                self._recorder.write_serialized(topic, message, now)
            else:
                self._recorder.write(topic, message, now)
        except Exception as error:
            self._refused.setdefault(topic, str(error))

    def _told(self) -> str:
        recorder = self._recorder
        topics = counted(len(recorder.topics), "topic")
        lines = [f"{self.path}: {counted(len(recorder), 'message')} on {topics}"]
        return "\n".join(
            [*lines, *(f"{topic} is not complete: {why}" for topic, why in self._refused.items())]
        )


def file_name(test: str) -> str:
    """The name of a test's bag, from the name of the test."""
    return f"{_NOT_IN_NAMES.sub('_', test).strip('_')[:100]}.mcap"
