"""Observations of a running system: its graph, and a node as a NoDL document."""
