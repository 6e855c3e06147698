"""`ifgen lifecycle`: the states of lifecycle nodes, and how they change."""
