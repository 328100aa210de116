"""What calls raise."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .reports import StepReport


class Error(ValueError):
    """Bad input: one sentence that names what, where, the value and the remedy. Nothing has changed."""

    # As `isochor.Error` in messages, wherever it is defined.
    __module__ = "isochor"


class _StepError(Error):
    __module__ = "isochor"

    def __init__(self, message: str, report: StepReport | None = None) -> None:
        super().__init__(message)
        self.report = report

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.report)


class NotConverged(_StepError):
    """A step found no equilibrium. The world is as it was, or at the last increment that converged.

    ``report`` is the :class:`StepReport` of the step; ``report.time`` says how far it got.
    """

    __module__ = "isochor"


class Cancelled(_StepError):
    """A step was stopped by ``World.cancel()``. ``report.time`` says how far it got."""

    __module__ = "isochor"
