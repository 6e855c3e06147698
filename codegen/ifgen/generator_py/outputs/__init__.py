"""The additions of users to packages: outputs of their own templates, and a pyproject.toml for pip."""
