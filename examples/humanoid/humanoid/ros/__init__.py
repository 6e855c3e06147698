"""Everything that deals with ROS messages: conversions, diagnostics and a fast executor."""
