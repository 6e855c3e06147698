"""Readings of one moment, and stamps that are wrong."""

from __future__ import annotations

import pytest

pytest.importorskip("mujoco")
from humanoid.data import SECOND
from humanoid.ros.recent import Recent, leapt

TICK = 4_000_000


class Topics:
    """Two topics of one simulator."""

    def __init__(self) -> None:
        self.joints, self.imu = Recent[str](), Recent[str]()
        self.began_anew = 0

    def put(self, topic: Recent[str], stamp: int) -> bool:
        """Take a reading as a node does; returns whether it is used."""
        if topic.put(stamp, ""):
            return True
        self.began_anew += leapt(self.joints, self.imu)
        return topic.newest == stamp

    def tick(self, stamp: int) -> bool:
        """Both readings of a moment; returns whether both are used in the end."""
        self.put(self.joints, stamp)
        self.put(self.imu, stamp)
        return self.joints.has(stamp) and self.imu.has(stamp)


@pytest.fixture
def topics() -> Topics:
    """Topics that are a second old."""
    made = Topics()
    assert all(made.tick(stamp) for stamp in range(0, SECOND, TICK))
    return made


@pytest.mark.parametrize("wrong", [SECOND // 2, 2 * SECOND, 10**9 * SECOND, -1, 0, -5 * SECOND])
def test_a_wrong_stamp_is_forgotten_with_the_next_tick(topics: Topics, wrong: int) -> None:
    topics.put(topics.imu, SECOND + wrong)
    assert topics.tick(SECOND)
    assert topics.tick(SECOND + TICK)
    assert topics.began_anew == 0


@pytest.mark.parametrize("now", [2 * TICK, SECOND - TICK])
def test_time_goes_back_once_all_say_so(now: int) -> None:
    topics = Topics()
    assert all(topics.tick(stamp) for stamp in range(0, now + TICK, TICK))
    assert not topics.put(topics.joints, 0)
    assert topics.put(topics.imu, 0)
    assert topics.began_anew == 1
    assert topics.tick(TICK)


def test_all_may_have_been_silent_for_long(topics: Topics) -> None:
    assert topics.tick(5 * SECOND)
    assert topics.began_anew == 0


def test_a_late_reading_takes_nothing_away(topics: Topics) -> None:
    topics.put(topics.joints, SECOND)
    assert not topics.put(topics.joints, SECOND - TICK)
    assert topics.put(topics.imu, SECOND)
    assert topics.joints.has(SECOND)
