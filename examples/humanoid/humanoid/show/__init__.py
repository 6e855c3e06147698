"""The demo: its nodes, its scenarios, and the windows, pictures and pages that show it."""
