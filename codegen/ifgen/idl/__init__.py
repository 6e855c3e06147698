"""What was written: the grammar of `.msg`, `.srv` and `.action` files, their tree and their comments."""
