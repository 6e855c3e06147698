"""From a running node to its description in NoDL."""
