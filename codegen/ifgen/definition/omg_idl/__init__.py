"""What an .idl file means, as rosidl_parser and the generators after it read it."""
