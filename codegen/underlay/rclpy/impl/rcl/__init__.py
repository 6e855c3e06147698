"""The part that upstream keeps in C; `rclpy._rclpy_pybind11` lists it under upstream's names."""
