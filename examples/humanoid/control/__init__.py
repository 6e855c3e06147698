"""What makes it stand and walk, 250 times a second."""
