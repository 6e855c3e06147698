"""MCAP (mcap.dev/spec): files of chunks, with an index at the end."""
