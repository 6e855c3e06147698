"""Templates: their variables, their check, their rendering, and users' own. jinja2 lives here only."""
