"""Code that all of Acme's messages share; not generated."""
