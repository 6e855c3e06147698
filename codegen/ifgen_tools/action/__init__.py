"""`ifgen action`: the actions of a running system, and goals for them."""
