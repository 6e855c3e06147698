"""ifgen.lock: the definitions and hashes of all interfaces that a project uses (docs/lock.md)."""
