"""`ifgen launch`: reads launch files to one model, the packages `launch` and `launch_ros`, and runs it."""
