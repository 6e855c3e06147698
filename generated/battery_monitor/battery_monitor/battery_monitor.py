"""The node battery_monitor: reports how long the battery will last."""

from __future__ import annotations

import math
from typing import Any

from humanoid.ros import messages
from humanoid.ros.diagnostics import Health
from humanoid.ros.running import run
from humanoid.simulation.battery import BatteryLimits, Level
from humanoid.simulation.battery import BatteryMonitor as Monitor
from humanoid_interfaces.msg import BatteryStatus
from sensor_msgs.msg import BatteryState
from std_srvs.srv import SetBool

from battery_monitor._battery_monitor_base import BatteryMonitorBase
from battery_monitor._battery_monitor_parameters import ParametersError


class BatteryMonitor(BatteryMonitorBase):
    """Reports once a second, and requests an emergency stop once, when the battery becomes critical."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._monitor = Monitor(BatteryLimits(low=self.parameters.low, critical=self.parameters.critical))
        self._health = Health("battery_monitor: inputs", self.get_logger(), "readings")
        self._called = False

    def on_battery_state(self, message: BatteryState) -> None:
        """Take a reading."""
        reading = self._health.read("readings", "/battery_state", messages.read_battery_state, message)
        if reading is not None:
            self._monitor.take(reading)

    def on_report_timer(self) -> None:
        """Publish the level."""
        now = self.get_clock().now().nanoseconds
        verdict = self._monitor.verdict(now)
        status = BatteryStatus(
            header=messages.header(now, ""),
            level=int(verdict.level),
            charging=verdict.charging,
            charge=math.nan,
            time_left=messages.duration_of(verdict.time_left),
        )
        if (reading := verdict.reading) is not None:
            status.charge, status.voltage = reading.charge, reading.voltage
            status.current, status.temperature = reading.current, reading.temperature
        self.publish_battery(status)
        critical = verdict.level is Level.CRITICAL
        if critical and not self._called and self.emergency_stop_set_client.service_is_ready():
            self.call_emergency_stop_set(SetBool.Request(data=True))
        self._called = critical


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(BatteryMonitor, args, ParametersError)


if __name__ == "__main__":
    main()
