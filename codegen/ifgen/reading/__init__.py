"""The files on disk: packages, their interfaces, and the lists in them."""
