"""The codec of a message: its program, and the renderings of the program."""
