"""What all of Acme's messages have in common; not generated."""
