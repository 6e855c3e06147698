"""Exchanges with other implementations of the conventions of rmw_zenoh: the proof that our wire is theirs."""
