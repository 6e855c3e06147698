"""Parameters of nodes in YAML, as rcl reads them: in files, on command lines, and in values."""
