"""`ifgen doctor`: what is missing on a machine, and what is wrong in a running system."""
