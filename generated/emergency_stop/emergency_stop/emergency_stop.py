"""The node emergency_stop: stops the robot in an emergency."""

from __future__ import annotations

from typing import Any

from humanoid.data import Cause, Mode
from humanoid.ros import messages
from humanoid.ros.running import run
from humanoid.simulation.safety import EmergencyStopLatch
from humanoid_interfaces.msg import BatteryStatus, GaitState
from std_srvs.srv import SetBool

from emergency_stop._emergency_stop_base import EmergencyStopBase
from emergency_stop._emergency_stop_parameters import ParametersError

_OPERATOR, _FALL, _BATTERY, _BEFORE = "operator", "fall", "battery", "emergency_stop"


class EmergencyStop(EmergencyStopBase):
    """A latched stop: it lasts until somebody releases it, and cannot be released while its cause lasts."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._latch = EmergencyStopLatch()
        self._told = False

    def on_gait_state(self, message: GaitState) -> None:
        """Stop if the robot has fallen, or if it was stopped before this node started."""
        if not self._told:
            self._begin(message)
        if message.mode == Mode.FALLEN and self.parameters.stop_on_fall:
            self._request(_FALL, Cause.FALL, "the robot has fallen")
        else:
            self._latch.withdraw(_FALL)

    def on_battery(self, message: BatteryStatus) -> None:
        """Stop if the battery is nearly empty."""
        critical = message.level == BatteryStatus.LEVEL_CRITICAL
        if critical and self.parameters.stop_on_critical_battery:
            self._request(_BATTERY, Cause.BATTERY, f"the battery is at {message.charge:.0%}")
        else:
            self._latch.withdraw(_BATTERY)

    def handle_set(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Press the button, or release it."""
        if request.data:
            self._request(_OPERATOR, Cause.OPERATOR, "the button was pressed")
            response.success = True
            return response
        self._latch.withdraw(_OPERATOR)
        response.success, response.message = self._latch.reset(self._now())
        if response.success:
            self.publish_emergency_stop(messages.emergency_stop(self._latch.status))
        return response

    def _begin(self, message: GaitState) -> None:
        """Publish whether the stop is active: a restart of this node must not lift an earlier stop."""
        self._told = True
        if message.mode == Mode.EMERGENCY_STOP and not self._latch.status.active:
            self._request(
                _BEFORE,
                Cause.UNKNOWN,
                f"was active before this node started: {messages.printable(message.reason)}"[:255],
            )
            self._latch.withdraw(_BEFORE)  # nobody requests it any longer, but somebody has to reset it
        else:
            self.publish_emergency_stop(messages.emergency_stop(self._latch.status))

    def _request(self, source: str, cause: Cause, reason: str) -> None:
        status = self._latch.request(source, cause, reason, self._now())
        if status is not None:
            self.publish_emergency_stop(messages.emergency_stop(status))
            self.get_logger().error(f"emergency stop: {reason}")

    def _now(self) -> int:
        return int(self.get_clock().now().nanoseconds)


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(EmergencyStop, args, ParametersError)


if __name__ == "__main__":
    main()
