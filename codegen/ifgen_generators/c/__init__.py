"""C99 structures of bounded size, and the tables that their codec reads. No heap, no recursion, no C library."""
