"""Tasks about events: how often they come, and how old their stamps are."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.clock import Clock, ClockType

from diagnostic_updater._diagnostic_updater import DiagnosticTask

if TYPE_CHECKING:
    from builtin_interfaces.msg import Time as TimeMsg
    from rclpy.time import Time

    from diagnostic_updater._diagnostic_status_wrapper import DiagnosticStatusWrapper

_S_PER_NS = 1e-9


class FrequencyStatusParam:
    """The frequencies [Hz] that are in order: `min`, and `max` if there is one; both may change later.

    :param freq_bound: the bounds by these names.
    :param tolerance: the part by which they may be missed.
    :param window_size: the number of updates that count.
    """

    def __init__(self, freq_bound: Mapping[str, float], tolerance: float = 0.1, window_size: int = 5) -> None:
        self.freq_bound = freq_bound
        self.tolerance = tolerance
        self.window_size = window_size


class FrequencyStatus(DiagnosticTask):
    """Watches how often `tick` is called."""

    def __init__(self, params: FrequencyStatusParam, name: str = "FrequencyStatus") -> None:
        super().__init__(name)
        self.params = params
        self.lock = threading.Lock()
        self.__clock = Clock(clock_type=ClockType.STEADY_TIME)
        self.clear()

    def clear(self) -> None:
        """Start over."""
        with self.lock:
            self.count = 0
            self.times = [self.__clock.now()] * self.params.window_size
            self.seq_nums = [0] * self.params.window_size
            self.hist_indx = 0

    def tick(self) -> None:
        """Count an event."""
        with self.lock:
            self.count += 1

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Compare the frequency of the window with the bounds."""
        bounds, tolerance = self.params.freq_bound, self.params.tolerance
        with self.lock:
            now, index = self.__clock.now(), self.hist_indx
            events = self.count - self.seq_nums[index]
            window = (now - self.times[index]).nanoseconds * _S_PER_NS
            self.seq_nums[index], self.times[index] = self.count, now
            self.hist_indx = (index + 1) % self.params.window_size
            since_start = self.count
        frequency = events / window if window > 0 else float("inf") if events else 0.0
        least, most = bounds["min"] * (1 - tolerance), None
        if "max" in bounds:
            most = bounds["max"] * (1 + tolerance)
        if events == 0:
            stat.summary(DiagnosticStatus.ERROR, "No events recorded.")
        elif frequency < least:
            stat.summary(DiagnosticStatus.WARN, "Frequency too low.")
        elif most is not None and frequency > most:
            stat.summary(DiagnosticStatus.WARN, "Frequency too high.")
        else:
            stat.summary(DiagnosticStatus.OK, "Desired frequency met")
        stat.add("Events in window", events)
        stat.add("Events since startup", since_start)
        stat.add("Duration of window (s)", f"{window:f}")
        stat.add("Actual frequency (Hz)", f"{frequency:f}")
        if most is not None and bounds["min"] == bounds["max"]:
            stat.add("Target frequency (Hz)", f"{bounds['min']:f}")
        if bounds["min"] > 0:
            stat.add("Minimum acceptable frequency (Hz)", f"{least:f}")
        if most is not None:
            stat.add("Maximum acceptable frequency (Hz)", f"{most:f}")
        return stat


class TimeStampStatusParam:
    """The ages [s] of stamps that are in order; a negative age is in the future."""

    def __init__(self, min_acceptable: float = -1, max_acceptable: float = 5) -> None:
        self.min_acceptable = min_acceptable
        self.max_acceptable = max_acceptable


class TimeStampStatus(DiagnosticTask):
    """Watches how old the stamps of events are, on a clock: system time if there is no other."""

    def __init__(
        self,
        params: TimeStampStatusParam | None = None,
        name: str = "Timestamp Status",
        clock: Clock | None = None,
    ) -> None:
        super().__init__(name)
        self.params = TimeStampStatusParam() if params is None else params
        self.lock = threading.Lock()
        self.early_count = self.late_count = self.zero_count = 0
        self.zero_seen = False
        self.__clock = Clock(clock_type=ClockType.ROS_TIME) if clock is None else clock
        self.__ages: list[float] = []

    def tick(self, stamp: float | Time | TimeMsg) -> None:
        """Note the stamp of an event: a number [s], a Time, or its message."""
        at = _seconds(stamp)
        with self.lock:
            if at == 0:
                self.zero_seen = True
            else:
                age = self.__clock.now().nanoseconds * _S_PER_NS - at
                self.__ages = [min(*self.__ages, age), max(*self.__ages, age)] if self.__ages else [age, age]

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Compare the ages since the last run with the bounds."""
        error, least, most = DiagnosticStatus.ERROR, self.params.min_acceptable, self.params.max_acceptable
        with self.lock:
            youngest, oldest = self.__ages or (0.0, 0.0)
            stat.summary(DiagnosticStatus.OK, "Timestamps are reasonable.")
            if not self.__ages and not self.zero_seen:
                stat.summary(DiagnosticStatus.WARN, "No data since last update.")
            if youngest < least:
                stat.summary(error, "Timestamps too far in future seen.")
                self.early_count += 1
            if oldest > most:
                stat.summary(error, "Timestamps too far in past seen.")
                self.late_count += 1
            if self.zero_seen:
                stat.summary(error, "Zero timestamp seen.")
                self.zero_count += 1
            self.__ages, self.zero_seen = [], False
        stat.add("Earliest timestamp delay:", f"{youngest:f}")
        stat.add("Latest timestamp delay:", f"{oldest:f}")
        stat.add("Earliest acceptable timestamp delay:", f"{least:f}")
        stat.add("Latest acceptable timestamp delay:", f"{most:f}")
        stat.add("Late diagnostic update count:", self.late_count)
        stat.add("Early diagnostic update count:", self.early_count)
        stat.add("Zero seen diagnostic update count:", self.zero_count)
        return stat


class Heartbeat(DiagnosticTask):
    """Says that the node lives."""

    def __init__(self) -> None:
        super().__init__("Heartbeat")

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Say so."""
        stat.summary(DiagnosticStatus.OK, "Alive")
        return stat


def _seconds(stamp: Any) -> float:
    """The time of a stamp [s]."""
    if isinstance(stamp, int | float):
        return float(stamp)
    if hasattr(stamp, "nanoseconds"):
        return float(stamp.nanoseconds) * _S_PER_NS
    return float(stamp.sec + stamp.nanosec * _S_PER_NS)
