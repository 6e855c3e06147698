"""Planning: goals, walks, dances and tasks, and the footsteps that they need."""
