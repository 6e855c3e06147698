"""Zenoh as a transport, by the conventions of rmw_zenoh as released for Jazzy (0.2.4) and later."""
