"""Serialise and deserialise eleven message types: ours beside rclpy, rosbags and mcap-ros2-support-fast.

    python benchmarks/codec.py [--rounds N] [WORD...]

All run interleaved in one process; the figures are process CPU time in microseconds per call, medians over
the rounds, garbage collection off. A peer that is not installed, or has no such type, shows as `-`. "C" is
ours with ifgen-ros-native, "Python" is ours without it. "cold" is that with all remembered strings forgotten
before each call. mcap-ros2-support-fast gives read-only views where the others give arrays. Needs `pip
install --group bench`.
"""

from __future__ import annotations

import argparse
import gc
import importlib
import math
import os
import platform
import statistics
import sys
import time
from array import array
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
OURS = ("C", "Python", "cold")
PEERS = (*OURS, "rclpy", "rosbags", "mcap-fast")
RATIOS = (
    *(f"{peer} / {ours}" for ours in ("C", "Python") for peer in PEERS[len(OURS) :]),
    "rclpy / cold",
    "Python / C",
)
BATCH_SECONDS = 0.004
Codec = tuple[Callable[[], Any], Callable[[], Any]]


def messages(types: Callable[[str], Any]) -> Iterator[tuple[str, Any]]:
    """The benchmark set: type names and filled messages, of the sizes of shared/facts/codec.md section 2."""
    time_type, header_type = types("builtin_interfaces/msg/Time"), types("std_msgs/msg/Header")
    point, vector = types("geometry_msgs/msg/Point"), types("geometry_msgs/msg/Vector3")
    quaternion, pose = types("geometry_msgs/msg/Quaternion"), types("geometry_msgs/msg/Pose")
    pose_stamped = types("geometry_msgs/msg/PoseStamped")

    def header(index: int = 0) -> Any:
        return header_type(stamp=time_type(sec=1700000000 + index, nanosec=123456), frame_id="base_link")

    def make(name: str, /, **fields: Any) -> tuple[str, Any]:
        return name, types(name)(**fields)

    def a_pose(index: float) -> Any:
        return pose(
            position=point(x=index, y=0.5, z=0.25), orientation=quaternion(x=0.0, y=0.0, z=0.6, w=0.8)
        )

    yield make("std_msgs/msg/String", data="hello world")
    yield make(
        "geometry_msgs/msg/Twist", linear=vector(x=1.0, y=2.0, z=3.0), angular=vector(x=0.1, y=0.2, z=0.3)
    )
    yield make("geometry_msgs/msg/PoseStamped", header=header(), pose=a_pose(1.5))
    yield make(
        "sensor_msgs/msg/Imu",
        header=header(),
        orientation=quaternion(x=0.0, y=0.0, z=0.6, w=0.8),
        angular_velocity=vector(x=0.1, y=0.2, z=0.3),
        linear_acceleration=vector(x=0.0, y=0.0, z=9.81),
    )
    joints = [index * 0.1 for index in range(30)]
    yield make(
        "sensor_msgs/msg/JointState",
        header=header(),
        name=[f"left_arm_joint_{index}" for index in range(30)],
        position=array("d", joints),
        velocity=array("d", joints),
        effort=array("d", joints),
    )
    poses = [pose_stamped(header=header(index), pose=a_pose(float(index))) for index in range(100)]
    yield make("nav_msgs/msg/Path", header=header(), poses=poses)
    pixels = array("B", bytes(range(256)) * 3600)
    yield make(
        "sensor_msgs/msg/Image",
        header=header(),
        height=480,
        width=640,
        encoding="rgb8",
        step=1920,
        data=pixels,
    )
    field = types("sensor_msgs/msg/PointField")
    yield make(
        "sensor_msgs/msg/PointCloud2",
        header=header(),
        height=1,
        width=100_000,
        fields=[field(name=name, offset=4 * i, datatype=7, count=1) for i, name in enumerate("xyzi")],
        point_step=16,
        row_step=1_600_000,
        data=array("B", bytes(1_600_000)),
        is_dense=True,
    )
    transform, stamped = types("geometry_msgs/msg/Transform"), types("geometry_msgs/msg/TransformStamped")
    rotation = quaternion(x=0.0, y=0.0, z=0.6, w=0.8)
    yield make(
        "tf2_msgs/msg/TFMessage",
        transforms=[
            stamped(
                header=header(index),
                child_frame_id=f"link_{index}",
                transform=transform(translation=vector(x=float(index), y=0.0, z=1.0), rotation=rotation),
            )
            for index in range(20)
        ],
    )
    status, pair = types("diagnostic_msgs/msg/DiagnosticStatus"), types("diagnostic_msgs/msg/KeyValue")
    yield make(
        "diagnostic_msgs/msg/DiagnosticArray",
        header=header(),
        status=[
            status(
                level=b"\0",
                name=f"motor driver {index}",
                message="all good",
                hardware_id=f"hw-{index}",
                values=[pair(key=f"key {value}", value=f"value {value * index}") for value in range(10)],
            )
            for index in range(20)
        ],
    )
    color = types("std_msgs/msg/ColorRGBA")
    yield make(
        "visualization_msgs/msg/Marker",
        header=header(),
        ns="plan",
        id=7,
        type=4,
        pose=a_pose(0.0),
        scale=vector(x=0.1, y=0.1, z=0.1),
        color=color(r=1.0, g=0.5, b=0.0, a=1.0),
        points=[point(x=index * 0.1, y=index * 0.2, z=0.0) for index in range(1000)],
    )


def our_types(codec: str) -> Callable[[str], Any]:
    """Our classes by type name, with the codec in C (`native`) or without (`python`).

    Their packages do not stay importable, so that ROS's own can follow. ImportError if C cannot run.
    """
    sys.path[:0] = [str(ROOT / "generated"), str(ROOT / "codegen")]
    packages = {path.name for path in (ROOT / "generated").iterdir() if path.is_dir()}
    classes: dict[str, Any] = {}

    def load(name: str) -> Any:
        if name not in classes:
            package, folder, cls = name.split("/")
            classes[name] = getattr(importlib.import_module(f"{package}.{folder}"), cls)
        return classes[name]

    choice = importlib.import_module("ifgen_runtime.codec.choice")
    os.environ[choice.VARIABLE] = codec
    choice.chosen.cache_clear()
    if codec == "native" and choice.chosen().extension is None:
        raise ImportError(choice.chosen().reason)
    for name, message in messages(load):
        load(name)
        message.__serialize__()  # now the class has its codec
    sys.path.remove(str(ROOT / "generated"))
    for module in [module for module in sys.modules if module.partition(".")[0] in packages]:
        del sys.modules[module]
    return classes.__getitem__


def native_codec(message: Any) -> Codec:
    """Our codec in C through the public functions."""
    from ifgen_native._native import deserialize, serialize

    data, cls = serialize(message), type(message)
    return lambda: serialize(message), lambda: deserialize(data, cls)


def python_codec(message: Any) -> Codec:
    """Our codec without C through the public functions, checks included."""
    from ifgen_runtime.codec import deserialize_in_python as deserialize
    from ifgen_runtime.codec import serialize_in_python as serialize

    data, cls = serialize(message), type(message)
    return lambda: serialize(message), lambda: deserialize(data, cls)


def cold_codec(message: Any) -> Codec:
    """Our codec without C when no string was seen before."""
    from ifgen_runtime.codec import deserialize_in_python as deserialize
    from ifgen_runtime.codec import serialize_in_python as serialize
    from ifgen_runtime.codec.texts import forget

    data, cls = serialize(message), type(message)

    def encode() -> bytes:
        forget()
        return serialize(message)

    def decode() -> Any:
        forget()
        return deserialize(data, cls)

    return encode, decode


def rclpy_codec(name: str, ours: Any, data: bytes) -> Codec:
    """`rclpy.serialization`, as nodes use it: compiled type support, checks off."""
    from rclpy.serialization import deserialize_message, serialize_message

    package, folder, cls_name = name.split("/")
    cls = getattr(importlib.import_module(f"{package}.{folder}"), cls_name)
    message = deserialize_message(data, cls)
    return lambda: serialize_message(message), lambda: deserialize_message(data, cls)


def rosbags_codec(name: str, ours: Any, data: bytes) -> Codec:
    """rosbags, with its own type store for Jazzy."""
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    message = store.deserialize_cdr(data, name)
    return lambda: store.serialize_cdr(message, name), lambda: store.deserialize_cdr(data, name)


def mcap_codec(name: str, message: Any, data: bytes) -> Codec:
    """mcap-ros2-support-fast, from our interface files. It cannot encode the arrays it decodes, only ours."""
    from mcap_ros2_support_fast._planner import create_decoder_function, create_encoder_function

    schema = _schema(name)
    encode, decode = create_encoder_function(name, schema), create_decoder_function(name, schema)
    own = decode(data)
    try:
        encode(own)
    except ValueError:
        own = message
    return lambda: encode(own), lambda: decode(data)


@cache
def _registry() -> Any:
    from ifgen import load

    return load(ROOT / "interfaces")


def _schema(name: str) -> str:
    """The definitions of a message and of everything that it refers to, as bags store them."""
    registry = _registry()
    names, texts = [name], []
    for current in names:
        message = registry.message(current)
        texts.append(message.source.text if current == name else f"MSG: {current}\n{message.source.text}")
        for field in message.fields:
            nested = getattr(getattr(field.type, "value_type", field.type), "type_name", None)
            if nested is not None and nested not in names:
                names.append(nested)
    return f"\n{'=' * 80}\n".join(texts)


def codecs(name: str, message: Any, in_c: Any) -> dict[str, Codec]:
    """Every installed codec that knows the type, by peer. `in_c` is the same message for C, if that runs."""
    found: dict[str, Codec] = {"Python": python_codec(message), "cold": cold_codec(message)}
    if in_c is not None:
        found["C"] = native_codec(in_c)
    data = found["Python"][0]()
    makers = {"rclpy": rclpy_codec, "rosbags": rosbags_codec, "mcap-fast": mcap_codec}
    for peer, make in makers.items():
        with suppress(ImportError):
            found[peer] = make(name, message, data)
    return found


def measure(codec_set: dict[str, Codec], rounds: int) -> dict[tuple[str, int], float]:
    """Median seconds per call, by peer and direction (0 serialise, 1 deserialise), interleaved."""
    functions = {(peer, way): pair[way] for peer, pair in codec_set.items() for way in (0, 1)}
    calls = {key: _calls(function) for key, function in functions.items()}
    times: dict[tuple[str, int], list[float]] = {key: [] for key in functions}
    for _ in range(rounds):
        for key, function in functions.items():
            times[key].append(_time(function, calls[key]))
    return {key: statistics.median(values) for key, values in times.items()}


def _calls(function: Callable[[], Any]) -> int:
    function()
    return max(1, int(BATCH_SECONDS / max(_time(function, 5), 1e-8)))


def _time(function: Callable[[], Any], calls: int) -> float:
    start = time.process_time_ns()
    for _ in range(calls):
        function()
    return (time.process_time_ns() - start) / calls / 1e9


def table(results: dict[str, dict[tuple[str, int], float]], way: int) -> str:
    """The Markdown tables of one direction: microseconds, and how many times ours is faster."""
    times = [f"| {' | '.join(['type', *PEERS])} |", f"|---{'|---:' * len(PEERS)}|"]
    lines = [f"| {' | '.join(['type', *RATIOS])} |", f"|---{'|---:' * len(RATIOS)}|"]
    ratios: dict[str, list[float]] = {column: [] for column in RATIOS}
    for type_name, measured in results.items():
        name = type_name.rpartition("/")[2]
        cells = [f"{measured[peer, way] * 1e6:.2f}" if (peer, way) in measured else "-" for peer in PEERS]
        times.append(f"| {' | '.join([name, *cells])} |")
        cells = [name]
        for column, values in ratios.items():
            peer, _, base = column.partition(" / ")
            if (peer, way) in measured and (base, way) in measured:
                values.append(measured[peer, way] / measured[base, way])
                cells.append(f"{values[-1]:.1f}")
            else:
                cells.append("-")
        lines.append(f"| {' | '.join(cells)} |")
    means = [f"**{math.exp(statistics.fmean(map(math.log, v))):.2f}**" if v else "-" for v in ratios.values()]
    lines.append(f"| {' | '.join(['**geometric mean**', *means])} |")
    return "\n".join([*times, "", *lines])


def _versions() -> str:
    found = [f"Python {platform.python_version()}"]
    for distribution in ("numpy", "ros-rclpy", "rosbags", "mcap-ros2-support-fast"):
        with suppress(PackageNotFoundError):
            found.append(f"{distribution} {version(distribution)}")
    return ", ".join(found)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=11)
    parser.add_argument("types", nargs="*", help="only types whose name holds one of these words")
    arguments = parser.parse_args()
    gc.disable()
    in_python, in_c = dict(messages(our_types("python"))), {}
    with suppress(ImportError):
        in_c = dict(messages(our_types("native")))
    results = {
        name: measure(codecs(name, message, in_c.get(name)), arguments.rounds)
        for name, message in in_python.items()
        if not arguments.types or any(word in name for word in arguments.types)
    }
    print(_versions() + "\n")
    print("### Serialise (µs)\n\n" + table(results, 0))
    print("\n### Deserialise (µs)\n\n" + table(results, 1))


if __name__ == "__main__":
    main()
