"""Commands that run something until it ends, or Ctrl-C ends it."""
