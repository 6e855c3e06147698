"""The commands about two versions of an interface."""
