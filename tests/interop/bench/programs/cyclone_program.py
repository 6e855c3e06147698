"""A program on Eclipse Cyclone DDS: topics under the names that ROS gives them on DDS."""

from __future__ import annotations

import dataclasses
import os
from dataclasses import dataclass
from importlib import import_module
from types import new_class
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from tests.interop.bench.programs.conversation import Receiver, Value, converse, plain, unpacked, wait_for
else:
    from conversation import Receiver, Value, converse, plain, unpacked, wait_for

_TO_BLOCK = 1.0  # [s] for a reliable writer
_ON_THIS_MACHINE = """
<CycloneDDS><Domain><General>
  <Interfaces><NetworkInterface name="lo"/></Interfaces><AllowMulticast>false</AllowMulticast>
</General><Discovery>
  <ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>
  <Peers><Peer address="127.0.0.1"/></Peers>
</Discovery></Domain></CycloneDDS>
"""
"""How ROS configures it where ROS_AUTOMATIC_DISCOVERY_RANGE is LOCALHOST."""


class CycloneProgram(Receiver):
    """A participant with readers and writers. A reader is emptied when it is asked what has come."""

    lacks: ClassVar[dict[str, str]] = {}

    def __init__(self, setting: dict[str, Any]) -> None:
        super().__init__()
        os.environ["CYCLONEDDS_URI"] = _ON_THIS_MACHINE
        self._classes = _classes()
        self._domain: Any = import_module("cyclonedds.domain")
        self._participant = self._domain.DomainParticipant(setting["domain"])
        self._writers: dict[str, tuple[Any, str]] = {}
        self._readers: dict[str, tuple[Any, Value]] = {}
        self._shapes: dict[str, Value] = setting["shapes"]

    def publish(self, topic: str, type: str, qos: Value) -> None:
        """Make a writer."""
        made = import_module("cyclonedds.pub").DataWriter(
            self._participant, self._topic(topic, type, qos), qos=_profile(qos)
        )
        self._writers[topic] = made, type

    def send(self, topic: str, value: Value) -> None:
        """Write a sample."""
        writer, type_name = self._writers[topic]
        writer.write(_made(self._classes[type_name], value))

    def subscribe(self, topic: str, type: str, qos: Value) -> None:
        """Make a reader."""
        self.came[topic] = []
        reader = import_module("cyclonedds.sub").DataReader(
            self._participant, self._topic(topic, type, qos), qos=_profile(qos)
        )
        self._readers[topic] = reader, self._shapes[type]

    def received(self, topic: str, count: int, seconds: float) -> list[Value]:
        """Everything that has come: after as many seconds, or earlier if that is `count` of them."""
        (reader, shape), queue = self._readers[topic], self.came[topic]

        def is_enough() -> bool:
            # An instance that is gone is a sample of another class.
            queue.extend(
                plain(sample, shape) for sample in reader.take(100) if dataclasses.is_dataclass(sample)
            )
            return len(queue) >= count

        wait_for(is_enough, seconds)
        found = queue[:]
        del queue[: len(found)]
        return found

    def _topic(self, topic: str, type_name: str, qos: Value) -> Any:
        name = f"rt/{topic.lstrip('/')}"
        made = import_module("cyclonedds.topic").Topic
        return made(self._participant, name, self._classes[type_name], qos=_profile(qos))


def _profile(qos: Value) -> Any:
    core: Any = import_module("cyclonedds.core")
    policy, seconds = core.Policy, import_module("cyclonedds.util").duration
    return core.Qos(
        policy.Reliability.Reliable(seconds(seconds=_TO_BLOCK))
        if qos["reliable"]
        else policy.Reliability.BestEffort,
        policy.Durability.TransientLocal if qos["transient_local"] else policy.Durability.Volatile,
        policy.History.KeepLast(qos["depth"]),
        # What it keeps for those who come late; without it, that is one.
        policy.DurabilityService(
            cleanup_delay=0,
            history=policy.History.KeepLast(qos["depth"]),
            max_samples=-1,
            max_instances=-1,
            max_samples_per_instance=-1,
        ),
    )


def _classes() -> dict[str, Any]:
    """The classes of the samples by the names of their types in ROS."""
    idl: Any = import_module("cyclonedds.idl")
    types: Any = import_module("cyclonedds.idl.types")
    made: dict[str, Any] = {}

    def define(name: str, /, **fields: Any) -> Any:
        package, _, short = name.partition("/msg/")
        named = {"typename": f"{package}.msg.dds_.{short}_"}
        bare = new_class(short, (idl.IdlStruct,), named, lambda body: body.update(__annotations__=fields))
        made[name] = dataclass(bare)
        return made[name]

    sequence, array = types.sequence, types.array
    time = define("builtin_interfaces/msg/Time", sec=types.int32, nanosec=types.uint32)
    header = define("std_msgs/msg/Header", stamp=time, frame_id=str)
    define("std_msgs/msg/String", data=str)
    numbers = sequence[types.float64]
    define(
        "sensor_msgs/msg/JointState",
        header=header,
        name=sequence[str],
        position=numbers,
        velocity=numbers,
        effort=numbers,
    )
    quaternion = define("geometry_msgs/msg/Quaternion", **dict.fromkeys("xyzw", types.float64))
    vector = define("geometry_msgs/msg/Vector3", **dict.fromkeys("xyz", types.float64))
    matrix = array[types.float64, 9]
    define(
        "sensor_msgs/msg/Imu",
        header=header,
        orientation=quaternion,
        orientation_covariance=matrix,
        angular_velocity=vector,
        angular_velocity_covariance=matrix,
        linear_acceleration=vector,
        linear_acceleration_covariance=matrix,
    )
    define(
        "sensor_msgs/msg/Image",
        header=header,
        height=types.uint32,
        width=types.uint32,
        encoding=str,
        is_bigendian=types.uint8,
        step=types.uint32,
        data=sequence[types.uint8],
    )
    return made


def _made(cls: Any, value: Value) -> Any:
    fields = {field.name: field.type for field in dataclasses.fields(cls)}
    return cls(**{name: _field(fields[name], each) for name, each in value.items()})


def _field(kind: Any, value: Any) -> Any:
    if isinstance(value, dict):
        return unpacked(value) if "base64" in value else _made(kind, value)
    return value


if __name__ == "__main__":
    converse(CycloneProgram, ["cyclonedds"])
