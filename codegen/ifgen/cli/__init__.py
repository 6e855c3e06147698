"""The commands: what one types, and what one reads."""
