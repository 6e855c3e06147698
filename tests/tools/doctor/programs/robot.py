"""One of two nodes with a topic, a service and an action: `robot.py driver old`, `robot.py monitor new`.

With `silent` at the end it does not spin, so it answers nobody.
"""

import sys
import time
from contextlib import suppress

import ifgen.dynamic
import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import ExternalShutdownException

BATTERY = "float32 voltage  # [V]\nuint8 status\n"
NEW_BATTERY = "float32 voltage  # [V]\nfloat32 current  # [A]\nuint8 status\n"
STATE = "string name\nBattery[<=2] batteries\n"
MODE = "{} mode\n---\nbool success\n"
WALK = "float32 distance 0.1\n---\nbool success\n---\nBattery battery\n"

name, version, *how = sys.argv[1:]
is_new = version == "new"
battery = {"robot_msgs/msg/Battery": NEW_BATTERY if is_new else BATTERY}
made = ifgen.dynamic.class_from_text
State = made("robot_msgs/msg/State", STATE, others=battery)
Mode = made("robot_msgs/srv/SetMode", MODE.format("uint16" if is_new else "uint8"))
Walk = made("robot_msgs/action/Walk", WALK, others=battery)
Same = made("robot_msgs/msg/Same", "float32 x 0.1\n")
Other = made("robot_msgs/msg/Other", "float32 x\n") if is_new else Same

rclpy.init()
node = rclpy.create_node(name)
node.create_publisher(Same, "same", 10)
node.create_publisher(Other, "other", 10)
if is_new:
    node.create_subscription(State, "state", print, 10)
    node.create_client(Mode, "set_mode")
    client = ActionClient(node, Walk, "walk")
else:
    node.create_publisher(State, "state", 10)
    node.create_service(Mode, "set_mode", lambda request, response: response)
    server = ActionServer(node, Walk, "walk", lambda goal: Walk.Result())
with suppress(KeyboardInterrupt, ExternalShutdownException):
    while how == ["silent"]:
        time.sleep(0.1)
    rclpy.spin(node)
