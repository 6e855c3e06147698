"""The bytes of a message: the program that turns fields into CDR, for generators of every language."""
