"""A module with the same name as one in programs/."""

WHO = "bystander"
