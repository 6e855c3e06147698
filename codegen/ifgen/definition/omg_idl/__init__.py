"""The meaning of an .idl file, as rosidl_parser and the generators after it read it."""
