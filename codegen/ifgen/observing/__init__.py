"""What a running system shows: its graph, and a node as a NoDL document."""
