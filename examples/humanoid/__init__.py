"""A simulated humanoid: its model, its physics and what its nodes compute. See README.md beside this file."""
