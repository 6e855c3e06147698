"""The part of ROS's rosidl_parser that messages use: the types in SLOT_TYPES. It parses nothing."""
