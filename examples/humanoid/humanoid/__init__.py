"""A simulated humanoid: its model, its physics and its nodes. README.md in this folder describes it."""
