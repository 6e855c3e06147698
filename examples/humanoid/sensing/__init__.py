"""What sensors say: where the robot is, and whose face it sees."""
