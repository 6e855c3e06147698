"""`ifgen node`: the nodes of a running system, and what each of them has."""
