"""A module that the package imports relatively, and reads as a resource."""

SPEED = 0.1
