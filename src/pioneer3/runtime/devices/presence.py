"""Whether a robot has a thing, and how one knows."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Presence:
    """Whether a device is there.

    Attributes:
        there: `None` where nobody can tell yet.
        reason: How one knows, or what to try; a sentence for a person.
    """

    there: bool | None
    reason: str

    def __str__(self) -> str:
        return self.reason
