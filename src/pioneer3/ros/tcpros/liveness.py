"""Which nodes respond: one that was killed stays registered, and one may hang."""

import asyncio
from collections.abc import Awaitable, Callable, Iterable
from typing import Final

from pioneer3.tasks import cancelled

PROMPT: Final = 0.5
"""Longest wait for answers at a look [s]; later ones count at the next."""


class Liveness:
    """Asks nodes side by side, each at most once at a time, and keeps the last answer."""

    def __init__(self, ask: Callable[[str], Awaitable[bool]]) -> None:
        self._ask = ask
        self._known: dict[str, bool] = {}
        self._asking: dict[str, asyncio.Task[None]] = {}

    async def among(self, names: Iterable[str]) -> set[str]:
        """Return the nodes that respond, or have not been found dead yet."""
        wanted = set(names)
        self._known = {name: known for name, known in self._known.items() if name in wanted}
        for name in wanted - self._asking.keys():
            self._asking[name] = asyncio.create_task(self._look(name))
        if wanted:
            await asyncio.wait([self._asking[name] for name in wanted], timeout=PROMPT)
        return {name for name in wanted if self._known.get(name, True)}

    async def close(self) -> None:
        """Ask no more."""
        await cancelled(self._asking.values())

    async def _look(self, name: str) -> None:
        try:
            self._known[name] = await self._ask(name)
        finally:
            del self._asking[name]
