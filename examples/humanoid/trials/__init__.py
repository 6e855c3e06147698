"""All of it in one process, for tests and benchmarks."""
