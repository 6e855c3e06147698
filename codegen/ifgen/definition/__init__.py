"""The meaning of interfaces: resolved types, checked names and values, derived messages, descriptions."""
