"""What reaches the disk: all changes of a run or none, and one run at a time."""
