"""Things of which Python has one in a process, for each of several programs in it."""
