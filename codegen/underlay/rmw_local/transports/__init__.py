"""Ways to other processes: what an engine has to offer (`interface`), and how a domain uses one (`link`).

Nothing here is imported, but `discovery`, until another process shows up.
"""


class TransportError(Exception):
    """Other processes cannot be reached; the text says why, in one line."""


class ConfigurationError(TransportError):
    """A configuration of the user that cannot be used: it does not help to try again."""
