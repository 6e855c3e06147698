"""The whole robot in one process, for tests and benchmarks."""
