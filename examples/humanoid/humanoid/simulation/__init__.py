"""The simulation: the robot in MuJoCo, with its camera, its battery and its emergency stop."""
