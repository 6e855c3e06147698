"""The conformance suite: asks a program to read and write messages, and compares its answers with those of real ROS."""
