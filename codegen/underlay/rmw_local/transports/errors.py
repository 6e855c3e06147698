"""The error of transports, apart from `seam`: a process that stays alone need not import that."""


class TransportError(Exception):
    """Other processes cannot be reached; the text says why, in one line."""
