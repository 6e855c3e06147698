"""Records what is published, and lets others pause it, split it and take snapshots."""
