"""Where its feet go next, and why: goals, walks, dances and tasks."""
