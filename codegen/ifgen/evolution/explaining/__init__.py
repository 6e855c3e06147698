"""Why two nodes that met do not match: what differs between their definitions, found while both run."""
