"""The parts of executors: watching entities, finding ready work, running it."""
