"""The first five minutes: generate every package that comes with ifgen, then use the packages.

Run it with `make demo` or `python examples/first_steps.py`. It needs only Python.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import ifgen
from ifgen import resources

# Late imports: the packages are there once they have been generated.


def main() -> None:
    """Generate and import packages, serialize and deserialize messages, and print type hashes."""
    with tempfile.TemporaryDirectory() as folder:
        generate(Path(folder))
        sys.path.insert(0, folder)  # as PYTHONPATH=folder would do
        call()
        plan_footsteps()
        refuse()


def generate(output: Path) -> None:
    """Turn interface files into typed Python packages."""
    started = time.perf_counter()
    done = ifgen.generate(resources.bundled_interfaces(), output=output)
    packages = len(list(output.iterdir()))
    heading("generate", "ifgen generate interfaces -o DIR")
    print(f"{packages} packages, {len(done.written)} files in {time.perf_counter() - started:.2f} s")


def call() -> None:
    """Use a service: it has a class for each part, and its bytes are those of ROS 2."""
    from humanoid_interfaces.srv import AddTwoInts
    from ifgen_runtime import deserialize, serialize

    heading("a service", "from humanoid_interfaces.srv import AddTwoInts")
    request = AddTwoInts.Request(a=2, b=40)
    response = AddTwoInts.Response(sum=request.a + request.b)
    data = serialize(response)
    print(f"request  {request}")
    print(f"on wire  {data.hex(' ', 4)}   ({len(data)} bytes of CDR)")
    print(f"back     {deserialize(data, AddTwoInts.Response)}")
    print(f"hash     {ifgen.type_hash('humanoid_interfaces/srv/AddTwoInts')}")


def plan_footsteps() -> None:
    """Use nested messages; constants, defaults and bounds come from the interface file."""
    from geometry_msgs.msg import Point
    from humanoid_interfaces.msg import Footstep, FootstepPlan
    from ifgen_runtime import deserialize, serialize, to_yaml

    heading("messages", "from humanoid_interfaces.msg import Footstep, FootstepPlan")
    plan = FootstepPlan(plan_id=7)
    for index in range(4):
        leg, y = (Footstep.LEG_LEFT, 0.1) if index % 2 == 0 else (Footstep.LEG_RIGHT, -0.1)
        plan.steps.append(Footstep(index=index, leg=leg, position=Point(x=0.2 * index, y=y)))
    data = serialize(plan)
    assert deserialize(data, FootstepPlan) == plan
    print(f"a plan of {len(plan.steps)} steps is {len(data)} bytes of CDR, and equal after the round trip")
    print("its third step as YAML:")
    print("".join(f"    {line}\n" for line in to_yaml(plan.steps[2]).splitlines()), end="")
    print(f"hash     {ifgen.type_hash('humanoid_interfaces/msg/FootstepPlan')}")


def refuse() -> None:
    """Try to send an invalid value: it is refused, and the error says where it is."""
    from humanoid_interfaces.msg import Footstep, FootstepPlan
    from ifgen_runtime import serialize

    heading("mistakes", "plan.steps[1].leg = 300; serialize(plan)")
    plan = FootstepPlan(steps=[Footstep(), Footstep()])
    plan.steps[1].leg = 300
    try:
        serialize(plan)
    except ValueError as error:
        print(f"{type(error).__name__}:\n    {error}")


def heading(what: str, code: str) -> None:
    """Print the heading of a part of the output."""
    print(f"\n-- {what}: {code}")


if __name__ == "__main__":
    main()
