"""The node footstep_generation_server: written once by ifgen, yours from then on.

`ifgen run -m footstep_generation_server.footstep_generation_server` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from humanoid_interfaces.srv import PlanFootsteps
from rclpy.executors import ExternalShutdownException

from footstep_generation_server._footstep_generation_server_base import FootstepGenerationServerBase
from footstep_generation_server._footstep_generation_server_parameters import ParametersError


class FootstepGenerationServer(FootstepGenerationServerBase):
    """Returns the footsteps that lead from a stance to a goal, or the reason why there are none. It moves
    nothing.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)

    def handle_plan_footsteps(
        self,
        request: PlanFootsteps.Request,
        response: PlanFootsteps.Response,
    ) -> PlanFootsteps.Response:
        """Answer a request to `/plan_footsteps`."""
        return response


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = FootstepGenerationServer()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"footstep_generation_server: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
