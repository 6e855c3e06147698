"""Runs programs written for rclpy: one as Python would, several in one process or in a process each."""
