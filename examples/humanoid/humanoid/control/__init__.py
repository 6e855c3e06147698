"""The control that makes the robot stand and walk, 250 times a second."""
