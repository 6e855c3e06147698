"""The demo: who is in it, what they are asked for, and how people see it."""
