"""The console script `director`: plays the people of a scenario, keeps score, and ends when it is over.

`director SCENARIO` runs beside the robot that a launch file has started. Its exit code is that of
`ifgen demo`: 0 if the robot did what it was asked to and did not fall.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.utilities import remove_ros_args

from ..ros.messages import printable
from ..ros.running import until_shutdown
from . import report
from .audience import Audience, AudienceError
from .director import Director
from .scenarios import ScenarioFileError, read

_TURN = 0.1  # s of real time between looks whether it is over
_CODE_INTERRUPTED = 130  # as for all commands of ifgen


def main(args: list[str] | None = None) -> int:
    """Watch a scenario to its end; returns 0, 1 if something failed or the robot fell, 130 after Ctrl-C."""
    words = sys.argv if args is None else args
    if len(names := remove_ros_args(words)[1:]) != 1:
        sys.exit("usage: director SCENARIO")
    rclpy.init(args=words)
    try:
        scenario = read(names[0])
        overrides = [Parameter(k, value=v) for k, v in scenario.get("audience", {}).items()]
        audience = Audience(parameter_overrides=[Parameter("use_sim_time", value=True), *overrides])
    except (ScenarioFileError, AudienceError) as error:
        rclpy.try_shutdown()
        sys.exit(f"error: {error}")
    director = Director(
        lambda what: print(f"{director.now:7.2f} s  {printable(what)}", flush=True), lambda: audience.is_over
    )
    executor = SingleThreadedExecutor()
    executor.add_node(audience)
    executor.add_node(director)
    started: float | None = None
    with until_shutdown():
        while not director.is_over:
            executor.spin_once(timeout_sec=_TURN)
            if started is None and director.begun is not None:
                started = time.monotonic()
    real = 0.0 if started is None else time.monotonic() - started
    failures = director.score.failures + ([] if director.is_over else ["interrupted"])
    simulated = director.now - (director.begun or 0.0)
    outcome = "; ".join(dict.fromkeys(failures)) or "done"
    name = Path(names[0]).stem
    report.show(report.summary(name, outcome, simulated, real, director.score))
    sys.stdout.flush()
    audience.destroy_node()
    director.destroy_node()
    rclpy.try_shutdown()
    if not director.is_over:
        return _CODE_INTERRUPTED
    return 1 if failures or director.score.falls else 0


if __name__ == "__main__":
    sys.exit(main())
