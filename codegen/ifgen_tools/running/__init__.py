"""Runs programs written for rclpy: one as Python would, several in a process each."""
