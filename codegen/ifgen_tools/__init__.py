"""The commands that look into running systems and into bags: `ifgen topic`, and others of its kind.

Each is a small program over public API, rclpy's above all, so it works on both transports. The command
`ifgen` finds them by the entry points in the group `ifgen.commands`.
"""
