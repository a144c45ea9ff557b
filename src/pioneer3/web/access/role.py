"""What somebody may do."""

from enum import StrEnum


class Role(StrEnum):
    """Viewers look, and stop the robot. Drivers do the rest as well."""

    VIEWER = "viewer"
    DRIVER = "driver"

    def covers(self, needed: "Role") -> bool:
        """Whether who has this role may do what `needed` may."""
        return self is Role.DRIVER or needed is Role.VIEWER
