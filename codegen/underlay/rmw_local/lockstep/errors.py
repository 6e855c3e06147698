"""The ends of lockstep runs."""


class LockstepError(RuntimeError):
    """A run in lockstep cannot go on; the text says which program is to blame, when, and why."""

    def __init__(self, text: str, exit_code: int = 1) -> None:
        super().__init__(text)
        self.exit_code = exit_code
        """The exit code of that program, or 1."""


class RunHasEnded(BaseException):
    """Raised in the programs of a run that has failed elsewhere, with the reason. No program handles it."""
