"""`ifgen service`: the services of a running system, calls of them, and what others call."""
