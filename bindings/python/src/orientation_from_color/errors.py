"""Errors: an argument that a call cannot take, or a picture that has no answer."""

from __future__ import annotations

from .enums import Reason, Status


class Error(ValueError):
    """A call did not do what it was asked for; `status` says why."""

    def __init__(self, status: Status, message: str = "") -> None:
        super().__init__(status, message)
        self.status = status
        self.message = message or status.message

    def __str__(self) -> str:
        return self.message


class Refused(Error):
    """The arguments are sound, but the picture does not determine the answer.

    `reason` says what that comes from and `advice` what to try. `result` is what was found on the way: a Solution, a Relief, a
    Paint or PixelCounts.
    """

    def __init__(self, status: Status, result: object = None, reason: Reason = Reason.NONE, details: str = "") -> None:
        words = status.message
        if details or reason is not Reason.NONE:
            words += f": {details or reason.message}"
        super().__init__(status, words)
        self.args = (status, result, reason, details)
        self.result = result
        self.reason = reason
        self.advice = reason.advice if reason is not Reason.NONE else ""

    def __str__(self) -> str:
        return f"{self.message}; try: {self.advice}" if self.advice else self.message
