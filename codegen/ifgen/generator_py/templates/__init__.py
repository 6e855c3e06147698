"""What templates are given, how they are checked and rendered, and users' own. jinja2 lives here only."""
