"""Every message, service and action of the packages named: type support, hash in the graph, bytes, round trip."""

import importlib
import sys

import rclpy
from ifgen_runtime import serialize
from rclpy.action import ActionServer
from rclpy.serialization import deserialize_message, serialize_message

rclpy.init()
node = rclpy.create_node("every_type")
counts = {"msg": 0, "srv": 0, "action": 0}
for package in sys.argv[1:]:
    for kind in counts:
        try:
            module = importlib.import_module(f"{package}.{kind}")
        except ModuleNotFoundError:
            continue
        for name in sorted(module.__all__):
            if kind != "msg" and "_" in name:  # a part of a service or action
                continue
            counts[kind] += 1
            cls = getattr(module, name)
            where = f"{package}_{name}".lower()
            if kind == "msg":
                publisher = node.create_publisher(cls, where, 1)
                [info] = node.get_publishers_info_by_topic(where)
                assert str(info.topic_type_hash) == cls.__type_hash__, name
                data = serialize_message(cls())
                assert data == serialize(cls()), name
                assert deserialize_message(data, cls) == cls(), name
                node.destroy_publisher(publisher)
            elif kind == "srv":
                node.destroy_service(node.create_service(cls, where, lambda request, response: response))
                node.destroy_client(node.create_client(cls, where))
            else:
                ActionServer(node, cls, where, lambda goal: None).destroy()
print(counts)
