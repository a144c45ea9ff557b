"""Draws the pictures of docs/explanation/architecture.md.

The layers are those that import-linter keeps.
"""

import tomllib
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Final
from xml.sax.saxutils import escape

if TYPE_CHECKING:
    from docs.plots.studio import Studio

ROOT: Final = Path(__file__).parents[2]
IMAGES: Final = ROOT / "docs/images"
WIDTH: Final = 400
"""Width of a picture; a phone shows it nearly in full size [px]."""
EDGE: Final = 14
"""From the border of a picture, or of a group, to what is in it [px]."""
GAP: Final = 26
"""Room for an arrow between two boxes [px]."""
LINE: Final = 18
"""From one line of text to the next [px]."""
BACK: Final = 28
"""Room for the arrow that leads back, at the right [px]."""
LAYER: Final = 32
"""From one line of a layer to the next [px]."""
LAYER_GAP: Final = 8
"""Between two layers, in addition [px]."""
LETTER: Final = 8.43
"""Width of a letter of a module's name [px]."""
INK: Final = "#1f2933"
"""Colour of text and arrows."""
COLORS: Final = {
    "people": ("#e3eefc", "#2f6fbd"),
    "decision": ("#fdf0d5", "#b7791f"),
    "driver": ("#e0f3e6", "#2f855a"),
    "base": ("#edf0f3", "#67737f"),
}
"""Fill and border of a group, by what is done there."""


STYLE: Final = f"""<style>
text {{ fill: {INK}; font: 14px system-ui, 'DejaVu Sans', sans-serif; }}
.module {{ font: 600 14px ui-monospace, 'DejaVu Sans Mono', monospace; }}
.title {{ font-weight: 700; }}
polyline {{ fill: none; stroke: {INK}; stroke-width: 1.5; }}
</style>
<marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">
<path d="M0 0 8 4 0 8z" fill="{INK}"/></marker>"""
"""Fonts and the tip of an arrow."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Box:
    """A station of a way: modules, what they do, and what leaves them."""

    modules: tuple[str, ...]
    does: str
    sends: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Group:
    """Stations in one place, each with an arrow to the next."""

    title: str
    color: str
    boxes: tuple[Box, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Way:
    """A picture: groups from top to bottom.

    `branches` is how many of the last groups are reached from the one before all of them, in
    place of one after the other. `back` names a module to which an arrow leads from the end.
    """

    name: str
    groups: tuple[Group, ...]
    branches: int = 0
    back: str = ""


def box(modules: str, does: str, sends: str = "") -> Box:
    """Return a station; `modules` are paths below src/pioneer3, with spaces between them."""
    return Box(modules=tuple(modules.split()), does=does, sends=sends)


KEY: Final = Way(
    name="key",
    groups=(
        Group(
            title="In the browser",
            color="people",
            boxes=(
                box("web/static/drive/keys.js", "a key goes down, or up"),
                box("web/static/drive/teleop.js", "refuses what cannot be driven now"),
                box(
                    "web/static/drive/drive.js",
                    "repeats the velocity; three zeros at the end",
                    "every 66 ms, by WebSocket",
                ),
            ),
        ),
        Group(
            title="In the server: who decides?",
            color="decision",
            boxes=(
                box("web/client.py", "may this client do that?"),
                box("web/control.py", "one operator has control"),
                box("behaviors/actions/hold.py", "wants this velocity, for 0.5 s at most"),
                box(
                    "runtime/arbiter.py behaviors/engine.py",
                    "ask all actions: the highest priority decides",
                    "one velocity",
                ),
            ),
        ),
        Group(
            title="The driver: is it safe?",
            color="driver",
            boxes=(
                box("robot/supervisor.py", "keeps the robot connected"),
                box("robot/pilot.py", "expiry, motors, stops: the motion that is due"),
                box("robot/limits.py", "the bounds, always last"),
                box("robot/session.py", "the only writer of the link"),
                box("arcos/host.py arcos/packet.py", "the command in bytes, in a frame"),
                box("links/stream.py", "serial line or TCP", "bytes, to the robot"),
            ),
        ),
    ),
)
GOTO: Final = Way(
    name="goto",
    back="navigation/localization.py",
    groups=(
        Group(
            title="Who asks: terminal, page, ROS",
            color="people",
            boxes=(
                box(
                    "cli/goto.py web/navigation.py ros/node/navigation.py",
                    "only translate",
                    "a place",
                ),
            ),
        ),
        Group(
            title="The goal, from request to end",
            color="decision",
            boxes=(
                box("navigation/navigator.py", "a robot on its map"),
                box("navigation/goals.py", "one goal at a time, with a status"),
                box("navigation/localization.py", "where is the robot, and is that sure?"),
                box("navigation/ways.py nav/planner.py", "the best way around all that was seen"),
                box("navigation/drives.py", "plans anew, waits behind others", "starts a mode"),
            ),
        ),
        Group(
            title="At each snapshot",
            color="driver",
            boxes=(
                box("navigation/follow_way.py", "what is around, does it come nearer?"),
                box("nav/follower.py", "the speeds that come on and keep clear"),
                box("runtime/arbiter.py", "goes on as for a key", "one velocity, to the driver"),
            ),
        ),
    ),
)
REPORT: Final = Way(
    name="report",
    branches=3,
    groups=(
        Group(
            title="The driver",
            color="driver",
            boxes=(
                box("links/stream.py", "bytes from the robot"),
                box("robot/session.py arcos/host.py", "read the link, know the session"),
                box("arcos/packet.py", "frames and checksums"),
                box("arcos/reports/codec.py", "the fields of a report"),
                box("robot/assemble.py", "a Snapshot in metres and radians"),
                box("robot/pilot.py", "sees it first: must the robot stop?"),
                box("robot/supervisor.py", "gives it to all; who is slow gets the newest"),
            ),
        ),
        Group(
            title="To modes: before all others",
            color="decision",
            boxes=(box("runtime/arbiter.py", "asks the actions for the next velocity"),),
        ),
        Group(
            title="To the page",
            color="people",
            boxes=(
                box("web/robot_view.py web/messages.py", "one text, encoded once for all"),
                box("web/broadcast.py", "the newest texts"),
                box("web/client.py", "sends them to one client", "by WebSocket"),
                box("web/static/model/robot.js", "what the page knows of a robot"),
            ),
        ),
        Group(
            title="To ROS",
            color="people",
            boxes=(
                box("ros/node/node.py ros/messages/update.py", "take each snapshot"),
                box("ros/node/publishing.py", "the topics that are due and subscribed to"),
                box("ros/messages", "fill the messages"),
                box("ros/ros1/middleware.py ros/ros2/middleware.py", "publish them"),
            ),
        ),
    ),
)
WAYS: Final = (KEY, GOTO, REPORT)
BANDS: Final = {
    "cli": ("What people meet", "people"),
    "navigation": ("One robot, with or without a map", "decision"),
    "robot": ("Its parts, which do not know each other", "driver"),
    "links": ("Bytes, protocols, files, models", "base"),
    "state": ("Base modules", "base"),
}
"""Titles and colours of groups of layers, by the first package of each."""


def layers() -> list[list[str]]:
    """Return the packages of each layer, from the top."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    (first, *_) = settings["tool"]["importlinter"]["contracts"]
    return [layer.split(" | ") for layer in first["layers"]]


@dataclass(slots=True)
class Sheet:
    """A picture while it is drawn."""

    parts: list[str] = field(default_factory=list)

    def text(self, x: float, y: float, words: str, style: str = "") -> None:
        """Write one line, in a class of the style sheet."""
        self.parts.append(f'<text class="{style}" x="{x:g}" y="{y:g}">{escape(words)}</text>')

    def rectangle(self, left: float, top: float, right: float, bottom: float, color: str) -> None:
        """Draw a group, or in `color`-box a white box with its border."""
        fill, border = COLORS[color.removesuffix("-box")]
        self.parts.append(
            f'<rect x="{left:g}" y="{top:g}" width="{right - left:g}" height="{bottom - top:g}" '
            f'rx="7" fill="{"#ffffff" if color.endswith("-box") else fill}" stroke="{border}"/>'
        )

    def arrow(self, *points: tuple[float, float]) -> None:
        """Draw an arrow along points."""
        line = " ".join(f"{x:g},{y:g}" for x, y in points)
        self.parts.append(f'<polyline points="{line}" marker-end="url(#tip)"/>')

    def svg(self, height: float) -> str:
        """Return the file: a white sheet, as readable in the dark as in the light."""
        return "\n".join(
            [
                f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height:g}" '
                f'width="{WIDTH}" height="{height:g}">',
                STYLE,
                f'<rect x="0.5" y="0.5" width="{WIDTH - 1}" height="{height - 1:g}" rx="10" '
                'fill="#ffffff" stroke="#c5ccd3"/>',
                *self.parts,
                "</svg>\n",
            ]
        )


def draw_group(
    sheet: Sheet, group: Group, left: float, top: float, right: float
) -> dict[str, float]:
    """Draw a group; return the middle of each module's box, and `end`, the last one's bottom."""
    middles: dict[str, float] = {}
    ends = [top + EDGE + LINE]
    for each in group.boxes:
        ends.append(ends[-1] + LINE * (len(each.modules) + 1) + 10 + GAP)
    sheet.rectangle(left, top, right, ends[-1] - GAP + EDGE, group.color)
    sheet.text(left + EDGE, top + 21, group.title, "title")
    for each, (y, end) in zip(group.boxes, pairwise(ends), strict=True):
        sheet.rectangle(left + EDGE, y, right - EDGE, end - GAP, f"{group.color}-box")
        for at, module in enumerate(each.modules):
            sheet.text(left + EDGE + 9, y + LINE * (at + 1), module, "module")
        sheet.text(left + EDGE + 9, y + LINE * (len(each.modules) + 1), each.does)
        middles |= dict.fromkeys(each.modules, (y + end - GAP) / 2)
        if each is not group.boxes[-1]:
            sheet.arrow((left + 40, end - GAP), (left + 40, end))
            sheet.text(left + 50, end - 8, each.sends)
    return middles | {"end": ends[-1] - GAP}


def draw_way(way: Way) -> str:
    """Return the picture of a way."""
    sheet = Sheet()
    left = EDGE + (BACK if way.branches else 0)
    right = WIDTH - EDGE - (BACK if way.back else 0)
    top = float(EDGE)
    middles: dict[str, float] = {}
    trunk = len(way.groups) - way.branches
    for number, group in enumerate(way.groups, 1):
        middles |= draw_group(sheet, group, left, top, right)
        end = middles["end"]
        top = end + EDGE + GAP
        if number <= trunk and (sends := group.boxes[-1].sends):
            sheet.arrow((left + 40, end), (left + 40, top))
            sheet.text(left + 50, end + EDGE + 18, sends)
        if number == trunk:
            fork = end - 14
        if number > trunk:
            to, x = middles[group.boxes[0].modules[0]], EDGE + 6
            sheet.arrow((left + EDGE, fork), (x, fork), (x, to), (left + EDGE, to))
    if way.back:
        x, to = right + 10, middles[way.back]
        sheet.arrow((right - EDGE, end - 20), (x, end - 20), (x, to), (right - EDGE, to))
        sheet.parts.append(
            f'<text transform="translate({x + 16:g} {to + 200:g}) rotate(-90)">'
            "scans, odometry</text>"
        )
    height = top if way.groups[-1].boxes[-1].sends else top - GAP
    return sheet.svg(height + EDGE)


def lines_of(row: list[str], room: float) -> list[list[str]]:
    """Return the packages of a layer in lines, none wider than `room` [px]."""
    lines: list[list[str]] = [[]]
    for name in row:
        if lines[-1] and sum(map(width_of, [*lines[-1], name])) > room:
            lines.append([])
        lines[-1].append(name)
    return lines


def width_of(name: str) -> float:
    """Return the width of a package's box with the gap behind it [px]."""
    return len(name) * LETTER + 24


def draw_layers() -> str:
    """Return the picture of the layers; imports go down, from any line to those below."""
    sheet = Sheet()
    left, right = float(EDGE), float(WIDTH - EDGE)
    rows = [(row, lines_of(row, right - left - 2 * EDGE)) for row in layers()]
    starts = [at for at, (row, _) in enumerate(rows) if row[0] in BANDS]
    top = left
    for start, end in pairwise([*starts, len(rows)]):
        title, color = BANDS[rows[start][0][0]]
        inside = sum(LAYER * len(lines) + LAYER_GAP for _, lines in rows[start:end])
        bottom = top + EDGE + LINE + inside + 4
        sheet.rectangle(left, top, right, bottom, color)
        sheet.text(left + EDGE, top + 21, title, "title")
        y = top + EDGE + LINE
        for _, lines in rows[start:end]:
            for line in lines:
                x = left + EDGE
                for name in line:
                    sheet.rectangle(x, y, x + width_of(name) - 8, y + LAYER - 6, f"{color}-box")
                    sheet.text(x + 8, y + 17, name, "module")
                    x += width_of(name)
                y += LAYER
            y += LAYER_GAP
        top = bottom + 8
    return sheet.svg(top - 8 + EDGE)


def main() -> None:
    """Write the pictures."""
    (IMAGES / "architecture-layers.svg").write_text(draw_layers())
    for way in WAYS:
        (IMAGES / f"architecture-{way.name}.svg").write_text(draw_way(way))


async def architecture(studio: "Studio") -> None:
    """Draw the layers, and the three ways through them."""
    main()
    for name in ("layers", *(way.name for way in WAYS)):
        studio.kept(f"architecture-{name}")
