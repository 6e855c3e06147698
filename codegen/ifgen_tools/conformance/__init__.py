"""The conformance suite: compares what a program reads and writes with the bytes of real ROS 2."""
