"""What users add to the packages: outputs of their own templates, and a pyproject.toml for pip."""
