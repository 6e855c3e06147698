"""The robot: the table that defines it, as a model for MuJoCo and as a description for ROS."""
