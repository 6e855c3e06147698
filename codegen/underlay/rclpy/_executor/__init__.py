"""What executors are made of: who watches what, which work is ready, who runs it."""
