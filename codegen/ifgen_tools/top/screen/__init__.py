"""The terminal view: what is shown, by which keys, and the terminal itself."""
