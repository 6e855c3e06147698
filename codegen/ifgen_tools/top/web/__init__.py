"""The same as one page in a browser on this machine."""
