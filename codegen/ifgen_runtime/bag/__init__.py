"""Reading and writing recordings of ROS 2, in MCAP and in rosbag2's SQLite, with typed messages.

Reading:

    from ifgen_runtime.bag import Bag

    with Bag("run") as bag:                      # a .mcap or .db3 file, or a folder of ros2 bag
        for topic in bag.topics.values():        # name, type_name, type_hash, qos, count, definitions
            print(topic.name, topic.type_name, topic.count)
        print(bag.start, bag.end, len(bag))      # [ns since 1970]

        for message in bag["/imu"]:              # of the installed class, or of one made for the file
            print(message.linear_acceleration.z)
        for recorded in bag:                     # all topics: .topic .received .published .message .data
            print(recorded.received, recorded.topic, recorded.message)
        bag.recorded("/imu", "/odom", start=bag.start, end=bag.start + 10**9)   # [start, end)
        bag["/imu"].between(start, end)          # the messages of a topic in a range of time

        bag["/joint_states"].column("position")  # numpy, of shape (n, joints)
        bag["/odom"].column("pose.pose.position.x")
        bag["/odom"].column("header.stamp")      # int64 [ns]
        bag["/odom"].received()                  # int64 [ns]
        bag["/odom"].frame()                     # pandas, where that is installed

Writing:

    from ifgen_runtime.bag import Recorder

    with Recorder("run.mcap") as recorder:       # or "run", a folder with metadata.yaml
        recorder.write("/imu", imu)              # received=..., published=... [ns]

A recorder also copies: `recorder.write_recorded(recorded)` writes what `for recorded in bag` returned, with
its definition, whatever is installed. `add_topic` and `write_serialized` take bytes.

The class of a message is the installed or generated one if its definition is that of the file: by the type
hash, or in old files by the text. Otherwise the toolkit makes one from the text in the file.
`Bag(path, classes={...})` takes yours.

All errors are BagError. A file that is damaged or cut off is read up to the damage, with a BagWarning that
says where it is; `Bag(path, strict=True)` raises. `bag.damage` lists what was met.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False
if TYPE_CHECKING:
    from ifgen_runtime.bag.errors import BagError as BagError
    from ifgen_runtime.bag.errors import BagWarning as BagWarning
    from ifgen_runtime.bag.errors import Damage as Damage
    from ifgen_runtime.bag.qos import OfferedQoS as OfferedQoS
    from ifgen_runtime.bag.reader import Bag as Bag
    from ifgen_runtime.bag.reader import Messages as Messages
    from ifgen_runtime.bag.recorder import Recorder as Recorder
    from ifgen_runtime.bag.topics import Definition as Definition
    from ifgen_runtime.bag.topics import Recorded as Recorded
    from ifgen_runtime.bag.topics import Topic as Topic

__all__ = [
    "Bag",
    "BagError",
    "BagWarning",
    "Damage",
    "Definition",
    "Messages",
    "OfferedQoS",
    "Recorded",
    "Recorder",
    "Topic",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Bag": "reader",
        "BagError": "errors",
        "BagWarning": "errors",
        "Damage": "errors",
        "Definition": "topics",
        "Messages": "messages",
        "OfferedQoS": "qos",
        "Recorded": "topics",
        "Recorder": "recorder",
        "Topic": "topics",
    },
)
