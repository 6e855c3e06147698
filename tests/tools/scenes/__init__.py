"""Programs on rclpy's public API that the tools look at: the same on real rclpy and on ours.

Each says `ready` once its nodes are there, and runs until it is interrupted. What it sends is the same in each run.
"""
