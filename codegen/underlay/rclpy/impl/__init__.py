"""What lies below rclpy's public modules."""
