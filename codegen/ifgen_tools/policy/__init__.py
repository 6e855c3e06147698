"""Access policies from a system's documents and launch files, and the gate in front of a running system."""
