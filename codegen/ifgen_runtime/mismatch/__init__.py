"""Endpoints that meet, and whose definitions of a type differ: what to do about it, and how to say it.

The graph of a transport tells who they are. Nothing here is imported before two definitions differ, or before
a node asks for another policy than to warn.
"""
