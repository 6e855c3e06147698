"""The exception of substitutions."""


class SubstitutionFailure(RuntimeError):
    """A substitution has no text in this context."""
