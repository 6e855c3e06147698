"""Three systems in the manner of public ones, in our own words: a navigation stack, a small base, a pipeline."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

FAST = "{history: KEEP_LAST, depth: 5, reliability: BEST_EFFORT}"
SAFE = "{history: KEEP_LAST, depth: 10, reliability: RELIABLE}"
KEPT = "{history: KEEP_LAST, depth: 1, reliability: RELIABLE, durability: TRANSIENT_LOCAL}"

LIFECYCLE = "codegen: {ifgen: {style: lifecycle}}\n"

Files = Mapping[str, str]
"""Texts by paths."""


def document(head: str = "", **lists: str) -> str:
    """A document: `publishers="scan sensor_msgs/LaserScan FAST"`, entries with `;` between them."""
    text = f"nodl_version: 2\n{head}"
    profiles = {"FAST": FAST, "SAFE": SAFE, "KEPT": KEPT}
    for category, entries in lists.items():
        text += f"{category}:\n"
        for entry in entries.split(";"):
            name, type_name, *qos = entry.split()
            profile = f", qos: {profiles[qos[0]]}" if qos else ""
            text += f"  - {{name: {name}, type: {type_name}{profile}}}\n"
    return text


def package(name: str, nodes: Files) -> dict[str, str]:
    """A package of Python with the documents of its nodes."""
    scripts = ", ".join(f'"{node} = {name}.{node}:main"' for node in nodes)
    return {
        f"{name}/package.xml": f'<package format="3"><name>{name}</name><version>1.0.0</version>'
        "<description>A part.</description><maintainer email='a@b.c'>A</maintainer><license>MIT</license>"
        "</package>\n",
        f"{name}/setup.py": f'setup(entry_points={{"console_scripts": [{scripts}]}})\n',
        **{f"{name}/nodl/{node}.nodl.yaml": text for node, text in nodes.items()},
    }


_PARAMETERS = """parameters:
  speed: {type: double, default_value: 0.5, validation: {bounds: [0.0, 2.0]}, read_only: true}
  frame: {type: string, default_value: map}
  retries: {type: int, default_value: 3}
"""

NAVIGATION: Files = {
    **package(
        "rover_nav",
        {
            "lidar": document(publishers="scan sensor_msgs/LaserScan FAST"),
            "charts": document(
                LIFECYCLE,
                publishers="map nav_msgs/OccupancyGrid KEPT",
                service_servers="load_map std_srvs/Trigger",
            ),
            "locator": document(
                "codegen: {ifgen: {style: lifecycle, frames: {broadcasts: {odom: map}}}}\n",
                subscriptions="scan sensor_msgs/LaserScan FAST; map nav_msgs/OccupancyGrid KEPT",
                publishers="pose geometry_msgs/PoseStamped SAFE",
            ),
            "planner": document(
                LIFECYCLE + _PARAMETERS,
                subscriptions="map nav_msgs/OccupancyGrid KEPT; pose geometry_msgs/PoseStamped SAFE",
                publishers="plan nav_msgs/Path SAFE",
                action_servers="compute_path example_interfaces/Fibonacci",
            ),
            "follower": document(
                "codegen: {ifgen: {style: lifecycle, frames: {uses: [odom]}, endpoints: "
                "{plan: {required: true}, cmd_vel: {exclusive: true}}}}\n" + _PARAMETERS,
                subscriptions="plan nav_msgs/Path SAFE; pose geometry_msgs/PoseStamped SAFE",
                publishers="cmd_vel geometry_msgs/Twist SAFE",
                service_servers="~/stop std_srvs/Trigger",
            ),
            "mission": document(
                LIFECYCLE,
                subscriptions="goal geometry_msgs/PoseStamped SAFE",
                action_clients="compute_path example_interfaces/Fibonacci",
                service_clients="load_map std_srvs/Trigger; /rover/follower/stop std_srvs/Trigger",
            ),
            "panel": document(publishers="goal geometry_msgs/PoseStamped SAFE"),
            "lifecycle_manager": document(
                "parameters:\n  node_names: {type: string_array}\n  autostart: {type: bool, default_value: true}\n"
            ),
            "base": document(
                "codegen: {ifgen: {frames: {broadcasts: {base_link: odom}}}}\n",
                subscriptions="cmd_vel geometry_msgs/Twist SAFE",
            ),
        },
    ),
    "rover_nav/config/nav.yaml": """/rover/planner:
  ros__parameters:
    speed: 1.5
    frame: map
    retries: 5
/rover/follower:
  ros__parameters:
    speed: 0.8
    frame: odom
""",
    "rover_nav/launch/nav.launch.py": """from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, GroupAction
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node, PushRosNamespace, SetParameter, SetRemap

CONFIG = str(Path(__file__).parents[1] / "config" / "nav.yaml")
MANAGED = ["charts", "locator", "planner", "follower", "mission"]


def generate_launch_description():
    nodes = [
        Node(package="rover_nav", executable="lidar", name="front", remappings=[("scan", "front/scan")]),
        Node(package="rover_nav", executable="charts", name="charts"),
        Node(package="rover_nav", executable="locator", name="locator", remappings=[("scan", "front/scan")]),
        Node(package="rover_nav", executable="planner", name="planner", parameters=[CONFIG]),
        Node(
            package="rover_nav",
            executable="follower",
            name="follower",
            parameters=[CONFIG, {"retries": 7}],
            remappings=[("cmd_vel", "drive")],
        ),
        Node(package="rover_nav", executable="mission", name="mission"),
        Node(package="rover_nav", executable="panel", name="panel"),
        Node(package="rover_nav", executable="base", name="base", remappings=[("cmd_vel", "drive")]),
        Node(
            package="rover_nav",
            executable="lifecycle_manager",
            name="manager",
            parameters=[{"node_names": MANAGED}],
        ),
    ]
    return LaunchDescription([
        DeclareLaunchArgument("record", default_value="true"),
        GroupAction([PushRosNamespace("rover"), SetParameter("use_sim_time", False), *nodes]),
        ExecuteProcess(
            cmd=["ros2", "bag", "record", "/rover/plan", "/rover/front/scan"],
            condition=IfCondition(LaunchConfiguration("record")),
        ),
    ])
""",
}

BASE: Files = {
    **package(
        "crab_base",
        {
            "driver": document(
                "codegen: {ifgen: {timers: [{name: odom, rate: 20.0, publishes: [odom]}],"
                " endpoints: {odom: {frame: odom, unit: m, version: 2.1.0}}}}\n"
                "parameters:\n  wheel_radius: {type: double}\n  port: {type: string, default_value: tty}\n",
                subscriptions="drive geometry_msgs/Twist SAFE; motor_power std_msgs/Bool KEPT",
                publishers="odom nav_msgs/Odometry SAFE; battery sensor_msgs/BatteryState SAFE",
                service_servers="reset_odometry std_srvs/Empty",
            ),
            "mux": document(
                subscriptions="input_teleop geometry_msgs/Twist SAFE; input_auto geometry_msgs/Twist SAFE",
                publishers="output geometry_msgs/Twist SAFE",
            ),
            "teleop": document(
                publishers="cmd_vel geometry_msgs/Twist SAFE",
                service_clients="reset_odometry std_srvs/Empty",
            ),
            "wander": document(
                "codegen: {ifgen: {endpoints: {odom: {rate: 10.0, frame: odom, unit: m, version: 2.0..3},"
                " ranges: {required: true}}}}\n",
                subscriptions="odom nav_msgs/Odometry SAFE; ranges sensor_msgs/LaserScan FAST",
                publishers="cmd_vel geometry_msgs/Twist SAFE",
            ),
            "sonar": document(publishers="ranges sensor_msgs/LaserScan FAST"),
            "power": document(
                subscriptions="battery sensor_msgs/BatteryState SAFE",
                publishers="motor_power std_msgs/Bool KEPT",
            ),
        },
    ),
    "crab_base/config/crab.yaml": """/crab/driver:
  ros__parameters:
    wheel_radius: 0.033
    port: ttyUSB0
""",
    "crab_base/launch/crab.launch.xml": """<launch>
  <arg name="robot" default="crab"/>
  <arg name="wander" default="true"/>
  <group>
    <push_ros_namespace namespace="$(var robot)"/>
    <node pkg="crab_base" exec="driver" name="driver">
      <param from="$(dirname)/../config/crab.yaml"/>
    </node>
    <node pkg="crab_base" exec="mux" name="mux">
      <remap from="output" to="drive"/>
    </node>
    <node pkg="crab_base" exec="teleop" name="teleop">
      <remap from="cmd_vel" to="input_teleop"/>
    </node>
    <node pkg="crab_base" exec="wander" name="wander" if="$(var wander)">
      <remap from="cmd_vel" to="input_auto"/>
      <remap from="ranges" to="sonar/ranges"/>
    </node>
    <node pkg="crab_base" exec="sonar" name="sonar">
      <remap from="ranges" to="sonar/ranges"/>
    </node>
    <node pkg="crab_base" exec="power" name="power"/>
    <node pkg="tf2_ros" exec="static_transform_publisher" name="mount"
          args="--frame-id base_link --child-frame-id sonar"/>
  </group>
</launch>
""",
}

PIPELINE: Files = {
    **package(
        "sight",
        {
            "camera": document(
                "codegen: {ifgen: {timers: [{name: frames, rate: 30.0, publishes: [image, info]}]}}\n"
                "parameters:\n  exposure: {type: int, default_value: 10, validation: {bounds: [1, 100]}}\n"
                "  mode: {type: string, default_value: auto, validation: {one_of<>: [[auto, fixed]]}}\n",
                publishers="image sensor_msgs/Image FAST; info sensor_msgs/CameraInfo FAST",
                service_servers="set_camera_info std_srvs/Trigger",
            ),
            "rectify": document(
                subscriptions="image sensor_msgs/Image FAST; info sensor_msgs/CameraInfo FAST",
                publishers="image_rect sensor_msgs/Image FAST",
            ),
            "detect": document(
                "parameters:\n  threshold: {type: double, default_value: 0.5, read_only: true}\n"
                "  labels: {type: string_array, default_value: [cup]}\n",
                subscriptions="image_rect sensor_msgs/Image FAST",
                publishers="objects geometry_msgs/PoseArray SAFE",
            ),
            "track": document(
                subscriptions="left_objects geometry_msgs/PoseArray SAFE; right_objects geometry_msgs/PoseArray SAFE",
                publishers="tracks geometry_msgs/PoseArray SAFE",
            ),
            "calibrate": document(service_clients="set_camera_info std_srvs/Trigger"),
            "world": document(
                subscriptions="tracks geometry_msgs/PoseArray SAFE",
                publishers="clock rosgraph_msgs/Clock SAFE",
            ),
        },
    ),
    "sight/launch/one_eye.launch.yaml": """launch:
  - arg: {name: side}
  - group:
      - push_ros_namespace: {namespace: $(var side)}
      - node:
          pkg: sight
          exec: camera
          name: camera
          param:
            - {name: exposure, value: 20}
            - {name: mode, value: fixed}
      - node: {pkg: sight, exec: rectify, name: rectify}
      - node_container:
          pkg: rclcpp_components
          exec: component_container
          name: components
          namespace: ""
          composable_node:
            - pkg: sight
              plugin: sight::Detect
              name: detect
              param:
                - {name: threshold, value: 0.7}
      - node: {pkg: sight, exec: calibrate, name: calibrate}
""",
    "sight/launch/eyes.launch.yaml": """launch:
  - set_use_sim_time: {value: true}
  - include:
      file: $(dirname)/one_eye.launch.yaml
      arg:
        - {name: side, value: left}
  - include:
      file: $(dirname)/one_eye.launch.yaml
      arg:
        - {name: side, value: right}
  - node:
      pkg: sight
      exec: track
      name: track
      remap:
        - {from: left_objects, to: left/objects}
        - {from: right_objects, to: right/objects}
  - node: {pkg: sight, exec: world, name: world}
  - executable: {cmd: ros2 bag record /tracks /left/image}
""",
}

SYSTEMS: Mapping[str, tuple[Files, str]] = {
    "navigation": (NAVIGATION, "rover_nav/launch/nav.launch.py"),
    "base": (BASE, "crab_base/launch/crab.launch.xml"),
    "pipeline": (PIPELINE, "sight/launch/eyes.launch.yaml"),
}
"""Each system with its launch file."""


def write(files: Files, folder: Path) -> None:
    """Write files below a folder."""
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
