"""Interfaces of humanoid_interfaces."""
