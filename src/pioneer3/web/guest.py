"""People and scripts, as the page knows them. They are compared by identity."""

from typing import Protocol

from pioneer3.web.access.role import Role


class Somebody(Protocol):
    """Who can have the wheel."""

    @property
    def name(self) -> str:
        """Shown to all."""


class Guest(Somebody, Protocol):
    """Who looks at the page."""

    @property
    def role(self) -> Role:
        """What they may do."""

    def tell(self, news: str) -> None:
        """Show `news`."""

    def wake(self) -> None:
        """Look for what is new."""
