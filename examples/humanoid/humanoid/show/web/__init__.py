"""The humanoid in a browser: one page that shows what the nodes publish."""
