"""Recordings: typed messages read from MCAP beside rosbags and mcap-ros2-support, and recording beside time.

    python benchmarks/bags.py [--rounds N]

All readers read the same file, written by ours, and decode every message of it, interleaved in one process.
The figures are process CPU time in microseconds per message, medians over the rounds. `ours, views` does not
copy sequences of numbers, as mcap-ros2-support and mcap-ros2-support-fast do not; only ours checks checksums.
A reader that is not installed shows as `-`. Needs `pip install --group bench`.
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "generated"), str(ROOT / "codegen")]

from codec import messages  # noqa: E402 - after the packages can be found
from ifgen_runtime.bag import Bag, Recorder  # noqa: E402

Reader = Callable[[Path], int]
PEERS = ("rosbags", "mcap-ros2-support", "mcap-ros2-support-fast")
ASKED = {"rosbags": 5.0, "mcap-ros2-support": 5.0, "mcap-ros2-support-fast": 2.0}
TOTAL = 8_000_000
"""Bytes of messages in each file, at most."""


def our_reader(path: Path) -> int:
    """Ours: opening the bag included, as for the others."""
    with Bag(path) as bag:
        return sum(1 for _ in bag["/topic"])


def our_reader_with_views(path: Path) -> int:
    """Ours, with arrays that show the bytes of their message."""
    with Bag(path, views=True) as bag:
        return sum(1 for _ in bag["/topic"])


def rosbags_reader(path: Path) -> int:
    """rosbags, with its own type store for Jazzy."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_JAZZY)) as reader:
        return sum(reader.deserialize(data, each.msgtype) is not None for each, _, data in reader.messages())


def mcap_reader(path: Path) -> int:
    """mcap-ros2-support on the library mcap."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        return sum(1 for _ in reader.iter_decoded_messages())


def fast_mcap_reader(path: Path) -> int:
    """mcap-ros2-support-fast on the library mcap."""
    from mcap.reader import make_reader
    from mcap_ros2_support_fast.decoder import DecoderFactory

    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        return sum(1 for _ in reader.iter_decoded_messages())


READERS: dict[str, Reader] = {
    "ours": our_reader,
    "ours, views": our_reader_with_views,
    "rosbags": rosbags_reader,
    "mcap-ros2-support": mcap_reader,
    "mcap-ros2-support-fast": fast_mcap_reader,
}


def our_types() -> Callable[[str], Any]:
    """Our classes by type name."""
    from ifgen_runtime.field_types import message_class

    def load(name: str) -> Any:
        package, folder, own = name.split("/")
        return message_class(f"{package}.{folder}", own)

    return load


def installed() -> dict[str, Reader]:
    """The readers that are there."""
    found: dict[str, Reader] = {}
    modules = {"rosbags": "rosbags", "mcap-ros2-support": "mcap_ros2"}
    modules["mcap-ros2-support-fast"] = "mcap_ros2_support_fast"
    for name, reader in READERS.items():
        try:
            __import__(modules.get(name, "ifgen_runtime"))
        except ImportError:
            continue
        found[name] = reader
    return found


def recorded(path: Path, message: Any) -> tuple[Path, int]:
    """A file of one message again and again, and how often."""
    from ifgen_runtime import serialize

    count = max(10, min(5_000, TOTAL // len(serialize(message))))
    with Recorder(path, overwrite=True) as recorder:
        for index in range(count):
            recorder.write("/topic", message, received=index * 1_000_000)
    return path, count


def reading(folder: Path, rounds: int) -> None:
    """Print the table of readers."""
    readers = installed()
    peers = [name for name in PEERS if name in readers]
    asked = ", ".join(f"{name} {ASKED[name]:g}x" for name in PEERS)
    print(f"### Reading: CPU [us] per message, and peer / ours (asked: {asked})\n")
    print(f"| type | ours | ours, views | {' | '.join(PEERS)} |\n|---|---:|---:{'|---:' * len(PEERS)}|")
    ratios: dict[str, list[float]] = {name: [] for name in peers}
    for type_name, message in messages(our_types()):
        path, count = recorded(folder / "run.mcap", message)
        times: dict[str, list[float]] = {name: [] for name in readers}
        for index in range(rounds + 1):
            for name, reader in readers.items():
                begin = time.process_time()
                assert reader(path) == count
                if index:  # the first round makes classes
                    times[name].append((time.process_time() - begin) / count * 1e6)
        medians = {name: statistics.median(values) for name, values in times.items()}
        cells = []
        for name in PEERS:
            if name in medians:
                ratios[name].append(medians[name] / medians["ours"])
                cells.append(f"{medians[name]:.1f} ({ratios[name][-1]:.1f}x)")
            else:
                cells.append("-")
        own = type_name.rpartition("/")[2]
        ours = f"{medians['ours']:.2f} | {medians['ours, views']:.2f}"
        print(f"| {own} | {ours} | {' | '.join(cells)} |", flush=True)
    means = [
        f"**{statistics.geometric_mean(ratios[name]):.1f}x**" if name in ratios else "-" for name in PEERS
    ]
    print(f"| **geometric mean** | | | {' | '.join(means)} |\n")


def pictures(count: int) -> list[Any]:
    """Images of 640 x 480 with noise of a camera over a scene: nothing that compresses to nothing."""
    import numpy as np
    from sensor_msgs.msg import Image

    chance = np.random.default_rng(7)
    rows, columns = np.mgrid[0:480, 0:640]
    scene = np.stack([rows / 2, columns / 3, (rows + columns) / 5], axis=2)
    found = []
    for index in range(count):
        noisy = scene + 4 * index + chance.normal(0, 2.0, scene.shape)
        data = noisy.clip(0, 255).astype(np.uint8)
        found.append(Image(height=480, width=640, encoding="rgb8", step=1920, data=data))
    return found


def recording(folder: Path) -> None:
    """Print how fast messages are recorded: as fast as possible, and at the rate that was asked for."""
    from sensor_msgs.msg import Imu

    images = pictures(8)
    size = len(images[0].data)
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    print(f"### Recording, while other programs wait for {load:.0f} processors\n")
    print(
        "| what | compression | asked | as fast as possible | per CPU second | CPU at the rate asked | late |"
    )
    print("|---|---|---:|---:|---:|---:|---:|")
    for compression in ("zstd", "lz4", "none"):
        path = folder / "images.mcap"
        rate = 200e6 / size
        most, of_cpu = (each * size / 1e6 for each in _fastest(path, compression, images, 600))
        used, late = _paced(path, compression, images, rate, 3.0)
        measured = f"{most:.0f} MB/s | {of_cpu:.0f} MB/s | {used:.0%} | {late}"
        print(f"| images of 0.9 MB | {compression} | 200 MB/s | {measured} |", flush=True)
    small = [Imu() for _ in range(8)]
    for compression in ("zstd", "lz4", "none"):
        path = folder / "small.mcap"
        most, of_cpu = _fastest(path, compression, small, 100_000)
        used, late = _paced(path, compression, small, 20_000, 3.0)
        measured = f"{most:,.0f}/s | {of_cpu:,.0f}/s | {used:.0%} | {late}"
        print(f"| Imu | {compression} | 20,000/s | {measured} |", flush=True)


def _fastest(path: Path, compression: Any, those: list[Any], count: int) -> tuple[float, float]:
    """Messages a second, and in a second of CPU, until all are written."""
    os.sync()
    begin, cpu = time.perf_counter(), time.process_time()
    with Recorder(path, compression=compression, overwrite=True) as recorder:
        for index in range(count):
            recorder.write("/topic", those[index % len(those)], received=index)
    return count / (time.perf_counter() - begin), count / (time.process_time() - cpu)


def _paced(path: Path, compression: Any, those: list[Any], rate: float, seconds: float) -> tuple[float, int]:
    """The load on one core at a rate, and how many messages were not recorded 0.1 s after the end."""
    count = round(rate * seconds)
    os.sync()
    begin, cpu = time.perf_counter(), time.process_time()
    with Recorder(path, compression=compression, overwrite=True) as recorder:
        index = 0
        while (now := time.perf_counter() - begin) < seconds + 0.1 and index < count:
            due = min(count, int(now * rate) + 1)
            for number in range(index, due):
                recorder.write("/topic", those[number % len(those)], received=number)
            index = due
            time.sleep(0.0005)
    load = (time.process_time() - cpu) / seconds
    with Bag(path, strict=True) as bag:
        found = sum(1 for _ in bag)
    return load, count - found


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--rounds", type=int, default=5, help="how often each file is read")
    rounds = parser.parse_args().rounds
    with tempfile.TemporaryDirectory() as folder:
        reading(Path(folder), rounds)
        recording(Path(folder))


if __name__ == "__main__":
    main()
