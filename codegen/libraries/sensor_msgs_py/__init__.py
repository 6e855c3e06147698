"""Messages of sensors as numpy arrays (sensor_msgs_py 5.3 of ROS 2 Jazzy)."""
