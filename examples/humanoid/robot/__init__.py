"""What the robot is: the table that it is made from, as a model for MuJoCo and as a description for ROS."""
