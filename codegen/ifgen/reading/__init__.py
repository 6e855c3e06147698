"""What lies on disk: packages, their files, what these list and say of themselves."""
