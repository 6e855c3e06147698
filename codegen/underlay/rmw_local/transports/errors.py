"""The error of transports, apart from `seam`: a process that stays alone need not import that."""


class TransportError(Exception):
    """Other processes cannot be reached; the text says why, in one line."""


class ConfigurationError(TransportError):
    """A configuration of the user that cannot be used: it does not help to try again."""
