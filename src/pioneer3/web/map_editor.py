"""Edits the map that robots of the page use: a draft, which is saved and then driven on.

There is one draft for all drivers. Robots keep to the map before until the draft is saved. Edits
wait in a queue and are carried out one by one, in a thread: a page that edits a large map can still
stop a robot.
"""

import asyncio
import logging
from collections import deque
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from pioneer3.errors import CommandError, PioneerError
from pioneer3.maps import Extent, LineMap, edit
from pioneer3.navigation.map_files import free_path, left_out, save_map
from pioneer3.sim.relief import Relief
from pioneer3.web import messages, requests
from pioneer3.web.page_map import PageMap
from pioneer3.web.world import map_message

log = logging.getLogger(__name__)

MOST_STEPS = 50
"""So many of the last edits can be undone."""
MOST_WAITING = 32
"""Edits that wait; more are refused."""
Answer = Callable[[messages.Message], None]


class MapEditor:
    """Carries out edits of the map that robots drive on; `publish` is given each new draft's text.

    Maps are saved in a folder. What takes long runs `in_thread`.
    """

    def __init__(self, page_map: PageMap, publish: Callable[[str], None]) -> None:
        self.folder = Path()
        self.in_thread: Callable[..., Awaitable[Any]] = asyncio.to_thread
        self._page_map, self._publish = page_map, publish
        self._base: LineMap | None = None
        self._steps: deque[LineMap] = deque(maxlen=MOST_STEPS)
        self._draft: LineMap | None = None
        self._version = 0
        self._waiting: deque[tuple[requests.MapEdit, Answer]] = deque()
        self._news = asyncio.Event()

    def ask(self, request: requests.MapEdit, answer: Answer) -> None:
        """Carry out an edit soon; a refusal and news go to `answer`."""
        if len(self._waiting) >= MOST_WAITING:
            answer(messages.EditRefused("too many edits at once; wait a moment"))
            return
        self._waiting.append((request, answer))
        self._news.set()

    def follow(self) -> None:
        """Drop the draft if robots use another map now."""
        if self._draft is not None and self._page_map.in_use is not self._base:
            self._forget()

    async def run(self) -> None:
        """Carry out edits until cancelled."""
        while True:
            await self._news.wait()
            self._news.clear()
            while self._waiting:
                request, answer = self._waiting.popleft()
                try:
                    await self._carry_out(request, answer)
                except PioneerError as error:
                    answer(messages.EditRefused(str(error)))
                except Exception:
                    log.exception("editing the map failed")
                    answer(messages.EditRefused("editing failed; the log has the details"))

    async def _carry_out(self, request: requests.MapEdit, answer: Answer) -> None:
        used = self._page_map.in_use
        if used is None:
            raise CommandError("there is no map to edit, or one is being made")
        self.follow()
        match request:
            case requests.UndoMapEdit():
                await self._undo()
            case requests.DiscardMapEdits():
                self._forget()
            case requests.SaveMap():
                await self._save(request, used, answer)
            case _:
                await self._edit(request, used)

    async def _edit(self, request: requests.MapChange, used: LineMap) -> None:
        before = self._draft or used
        if isinstance(request, requests.RenameObject | requests.RemoveObject) and (
            request.version != self._version or request.number >= len(before.objects)
        ):
            raise CommandError("the map has changed meanwhile; try again")
        after = await self.in_thread(changed, before, request)
        steps = len(self._steps) + 1
        relief, version = self._relief_of(after), self._version + 1
        text = await self.in_thread(_text_of, after, relief, version, steps)
        if self._page_map.in_use is not used:
            raise CommandError("the map has been replaced meanwhile")
        self._base = used
        self._steps.append(before)
        self._take(after, text)

    async def _undo(self) -> None:
        if not self._steps:
            raise CommandError("there is no edit to undo")
        before = self._steps.pop()
        if before is self._base:
            self._forget()
            return
        relief, version = self._relief_of(before), self._version + 1
        text = await self.in_thread(_text_of, before, relief, version, len(self._steps))
        self._take(before, text)

    async def _save(self, request: requests.SaveMap, used: LineMap, answer: Answer) -> None:
        draft = self._draft
        if draft is None:
            raise CommandError("nothing was edited")
        for robot in self._page_map.robots_on(used):
            if mode := robot.arbiter.mode:
                raise CommandError(f"a robot drives on the map before: end {mode.name} first")
        path = free_path(self.folder / f"{request.name}{request.format}")
        relief = self._relief_of(draft)
        await self.in_thread(save_map, draft, path, relief)
        news = f"Saved {path.name}, in the folder of this program."
        if lost := left_out(draft, path, relief):
            news += f" Not in it: {lost}."
        answer(messages.Told(news))
        if self._page_map.in_use is not used:
            raise CommandError(f"{path.name} is saved, but robots use another map meanwhile")
        for robot in self._page_map.robots_on(used):
            robot.arbiter.end_mode("the map has changed")
        self._page_map.replace(used, replace(draft, file=path))
        self._forget()

    def _relief_of(self, line_map: LineMap) -> Relief:
        """Return the heights of a draft."""
        used = self._page_map.in_use
        return self._page_map.relief.carried(used or line_map, line_map)

    def _take(self, draft: LineMap, text: str) -> None:
        self._version += 1
        self._draft = draft
        self._publish(text)

    def _forget(self) -> None:
        """Go back to the map in use."""
        self._version += 1
        self._draft = self._base = None
        self._steps.clear()
        self._publish(messages.encode(messages.MapDraft(None, self._version, 0)))


def changed(line_map: LineMap, request: requests.MapChange) -> LineMap:
    """Return a map after one edit; ConfigError, which says why, if it cannot be made."""
    match request:
        case requests.EraseWalls(x0, y0, x1, y1):
            box = Extent(min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1))
            return edit.erased(line_map, box)
        case requests.DrawWall(x0, y0, x1, y1):
            return edit.with_wall(line_map, (x0, y0), (x1, y1))
        case requests.Forbid(x0, y0, x1, y1, shape, name):
            return edit.with_forbidden(line_map, shape, (x0, y0), (x1, y1), name)
        case requests.NamePlace(role, name, x, y, heading):
            return edit.with_place(line_map, role, name, (x, y), heading)
        case requests.RenameObject(number, _, name):
            return edit.renamed(line_map, number, name)
        case requests.RemoveObject(number):
            return edit.without(line_map, number)


def _text_of(line_map: LineMap, relief: Relief, version: int, steps: int) -> str:
    drawing = map_message(line_map, relief).map
    return messages.encode(messages.MapDraft(drawing, version, min(steps, MOST_STEPS)))
