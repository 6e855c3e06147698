"""C++17 headers for messages, services and actions, which need no ROS."""
