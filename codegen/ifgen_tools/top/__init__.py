"""`ifgen top`: a running system at a glance, in a terminal or on a local page."""
