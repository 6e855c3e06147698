"""Uses the command line in every way that programs do."""

import argparse
import sys

import helper  # noqa: F401
import rclpy
from rclpy.utilities import remove_ros_args


def main(args=None):
    print(type(sys.argv), isinstance(sys.argv, list), sys.argv[1:], len(sys.argv))
    print(str.join(",", sys.argv[1:]), "--ros-args" in sys.argv, sys.argv.__add__(["x"])[-1])
    rclpy.init(args=args)
    node = rclpy.create_node("before")
    print(node.get_name(), node.get_namespace(), node.declare_parameter("rate", 1.5).value)
    parser = argparse.ArgumentParser(prog="arguments")
    parser.add_argument("speed", type=float)
    parser.add_argument("--name", default="nobody")
    print(parser.parse_args(remove_ros_args(sys.argv)[1:]))
    print(parser.parse_known_args()[0], remove_ros_args()[1:])
    node.destroy_node()
    rclpy.shutdown()
    rclpy.init()
    print(rclpy.create_node("again").get_name())
    rclpy.shutdown()
    sys.argv.append("more")
    sys.argv[1:2] = ["0.2"]
    print(sys.argv[1:])
    sys.argv = ["other", "--ros-args", "-r", "__ns:=/assigned"]
    from sys import argv

    print(argv is sys.argv, argv)
    rclpy.init()
    print(rclpy.create_node("third").get_namespace())
    rclpy.shutdown()
    try:
        parser.parse_args(["--help"])
    finally:
        print("helped")


if __name__ == "__main__":
    main(args=sys.argv)
