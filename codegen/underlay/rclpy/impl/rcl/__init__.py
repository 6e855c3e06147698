"""What upstream keeps in C; `rclpy._rclpy_pybind11` lists it under the names of that extension module."""
