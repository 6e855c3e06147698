"""The layers below rclpy's public modules."""
