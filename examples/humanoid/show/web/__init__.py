"""The humanoid in a browser: one page that shows what the nodes say to each other."""
