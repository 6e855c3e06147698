"""Sensing: estimates where the robot is, and detects the face that it sees."""
