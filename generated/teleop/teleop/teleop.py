"""The node teleop: steers the robot with a joystick."""

from __future__ import annotations

from typing import Any

from geometry_msgs.msg import Twist, Vector3
from humanoid.data import SECOND
from humanoid.planning.teleop import Teleop as Hand
from humanoid.planning.teleop import VelocityLimits
from humanoid.ros.running import run
from sensor_msgs.msg import Joy
from std_srvs.srv import SetBool

from teleop._teleop_base import TeleopBase
from teleop._teleop_parameters import ParametersError


class Teleop(TeleopBase):
    """Turns axes into velocities while the dead-man button is held."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        scale = self.parameters.scale
        limits = VelocityLimits(forward=scale.forward, sideways=scale.sideways, turn=scale.turn)
        self._hand = Hand(limits, round(self.parameters.joy_timeout * SECOND))
        self._stopping = False
        self._steering = False  # whether the last velocity was not zero

    def on_joy(self, message: Joy) -> None:
        """Take the axes and buttons."""
        axis, button, scale = self.parameters.axis, self.parameters.button, self.parameters.scale
        stop = _pressed(message, button.stop)
        if stop and not self._stopping:
            self.call_emergency_stop_set(SetBool.Request(data=True))
        self._stopping = stop
        held = _pressed(message, button.enable)
        forward, sideways, turn = (
            _value(message, number) * most * held
            for number, most in (
                (axis.forward, scale.forward),
                (axis.sideways, scale.sideways),
                (axis.turn, scale.turn),
            )
        )
        if not self._hand.command(forward, sideways, turn, self._now()):
            self.get_logger().warning("an axis is not a number", throttle_duration_sec=1.0)

    def on_command_timer(self) -> None:
        """Send the velocity; a zero once only, because others may steer then."""
        velocity = self._hand.update(self._now())
        steers = any(velocity)
        if steers or self._steering:
            forward, sideways, turn = velocity
            message = Twist(linear=Vector3(x=forward, y=sideways), angular=Vector3(z=turn))
            self.publish_teleop_velocity(message)
        self._steering = steers

    def _now(self) -> int:
        return int(self.get_clock().now().nanoseconds)


def _pressed(message: Joy, number: int) -> bool:
    return number < len(message.buttons) and bool(message.buttons[number])


def _value(message: Joy, number: int) -> float:
    return float(message.axes[number]) if number < len(message.axes) else 0.0


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(Teleop, args, ParametersError)


if __name__ == "__main__":
    main()
