"""What all visitors are told alike: made once, and the newest only for who is behind."""

from typing import Protocol


class Channel(Protocol):
    """Something that changes, as texts for pages."""

    @property
    def version(self) -> int:
        """Counts the changes."""

    def since(self, seen: int) -> list[str]:
        """Return what brings up to date who knows version `seen`; 0 for who knows nothing."""


class Notices:
    """A text for each key, told when it changes."""

    def __init__(self) -> None:
        self.version = 0
        self._texts: dict[str, tuple[int, str]] = {}

    def put(self, key: str, text: str) -> bool:
        """Make `text` the newest of `key`; return whether it is another one."""
        if key in self._texts and self._texts[key][1] == text:
            return False
        self.version += 1
        self._texts[key] = self.version, text
        return True

    def forget(self, key: str) -> None:
        """Tell nobody any more."""
        self._texts.pop(key, None)

    def since(self, seen: int) -> list[str]:
        """Return the texts that are newer, the oldest first."""
        return [text for version, text in sorted(self._texts.values()) if version > seen]
