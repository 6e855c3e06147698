"""What is meant: resolved types, checked names and values, derived messages and type descriptions."""
