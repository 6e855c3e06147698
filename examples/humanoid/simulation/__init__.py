"""The robot that MuJoCo steps, with its camera, its battery and its emergency stop."""
