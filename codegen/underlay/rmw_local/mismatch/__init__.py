"""Endpoints whose definitions of a type differ: what is decided, how messages pass, and what is said."""
