"""Errors by the exit status of the program. Files that this package itself cannot read raise BadInputError as well."""
from __future__ import annotations

import json
from typing import Dict, Type


class AlignGSError(Exception):
    """What is wrong (message), in which file (path) and part of it (field), and what to do about it (remedy)."""

    status = 1

    def __init__(self, message: str, path: str = "", field: str = "", remedy: str = "", status: int = 0):
        self.message, self.path, self.field, self.remedy = message, path, field, remedy
        self.status = status or type(self).status
        place = ", ".join(part for part in (path, field) if part)
        super().__init__((place + ": " if place else "") + message + (f" (remedy: {remedy})" if remedy else ""))


class FailedError(AlignGSError):
    """The work itself failed, or the program ended in a way that has no class of its own."""

    status = 1


class UsageError(AlignGSError):
    """Wrong options."""

    status = 2


class BadInputError(AlignGSError):
    """A file or folder that is not what it should be."""

    status = 3


class WeightsError(AlignGSError):
    """Weights of a network are missing."""

    status = 4


class ResourcesError(AlignGSError):
    """Memory, disk or device."""

    status = 5


class BelowThresholdError(AlignGSError):
    """A metric is below its --fail-under."""

    status = 6


class StoppedError(AlignGSError):
    """A signal stopped the program. Its training has a checkpoint: start it again with resume=True."""

    status = 75


class ProgramMissingError(AlignGSError):
    """The program aligngs is not installed."""

    status = 127


_BY_STATUS: Dict[int, Type[AlignGSError]] = {
    kind.status: kind
    for kind in (FailedError, UsageError, BadInputError, WeightsError, ResourcesError, BelowThresholdError, StoppedError)
}


def error_of(status: int, output: str, log: str) -> AlignGSError:
    """The error of an ended program. `output` is its standard output (--json), `log` its standard error."""
    kind = _BY_STATUS.get(status, FailedError)
    for text in (output, output[output.rfind('{\n  "error"'):]):  # --fail-under prints the figures first
        try:
            error = json.loads(text)["error"]
            return kind(str(error["message"]), str(error.get("path", "")), str(error.get("field", "")), str(error.get("remedy", "")), status)
        except (ValueError, KeyError, TypeError):
            continue
    lines = [line for line in log.strip().splitlines() if line.strip()]
    return kind(lines[-1].strip() if lines else f"the program ended with status {status}", status=status)
