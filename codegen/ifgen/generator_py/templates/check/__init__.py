"""The static check of templates: their syntax trees against the types of what they are given."""
