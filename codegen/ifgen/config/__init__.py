"""Settings of the user: options, [tool.ifgen], templates, and which warnings to report."""
