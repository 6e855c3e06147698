"""The database of rosbag2, in SQLite."""
