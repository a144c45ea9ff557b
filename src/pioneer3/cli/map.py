"""`pioneer3 map`: make maps, look at maps and worlds, check them, convert them."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import App, Parameter
from cyclopts.validators import Number

from pioneer3.cli.map_build import build
from pioneer3.cli.options import UNITS, Flag, Json
from pioneer3.cli.process import write_json, write_line
from pioneer3.errors import ConfigError
from pioneer3.units import ANGLE, LENGTH

if TYPE_CHECKING:
    from rich.console import Console

    from pioneer3.maps import Extent
    from pioneer3.sim.map_check import MapProblem
    from pioneer3.sim.map_convert import MapInfo

Lines = Annotated[
    tuple[str, ...], Parameter(metavar="LINE", allow_leading_hyphen=True, negative=())
]
Boxes = Annotated[tuple[str, ...], Parameter(metavar="BOX", allow_leading_hyphen=True, negative=())]
Places = Annotated[tuple[str, ...], Parameter(metavar="NAME=PLACE", negative=())]

map_app = App(
    name="map",
    help="""Make, show, check, edit and convert maps and worlds.

    They are ARIA .map files, ROS map_server .yaml files with their picture,
    .toml worlds: a map with robots, boxes and people, and .world and .sdf files
    of Stage and Gazebo.

    Example: pioneer3 map show office
    """,
)
map_app.command(build, help_epilogue=UNITS)


@map_app.command
def show(file: str) -> int:
    """Draw a map in the terminal; say how large it is and what is in it.

    Example: pioneer3 map show lab

    Args:
        file: A shipped map (office), or a .map, .yaml, .toml or .world file.
    """
    from pioneer3.cli.terminal import Terminal
    from pioneer3.sim.map_convert import look

    _print_map(look(file), Terminal())
    return 0


@map_app.command(name="list")
def list_maps(folder: Path = Path()) -> int:
    """List the maps and worlds that ship, and those in a folder.

    Example: pioneer3 map list

    Args:
        folder: Looked into, without the folders below.
    """
    from pioneer3.maps import shipped_maps
    from pioneer3.sim.worldfile import maps_in, shipped_worlds

    write_line(f"maps that ship: {', '.join(shipped_maps())}")
    write_line(f"worlds that ship: {', '.join(shipped_worlds())}")
    for path in maps_in(folder):
        write_line(str(path))
    return 0


@map_app.command
def check(
    file: str,
    *,
    robot: Annotated[str, Parameter(name=["--robot", "-r"])] = "p3at-sh",
    json: Json = False,
) -> int:
    """Say all that is wrong with a map: bad lines, homes in walls, goals out of reach.

    The exit code is 0 if nothing is, 1 after warnings, 2 after errors.

    Example: pioneer3 map check lab --robot p3dx

    Args:
        file: A shipped map (office), or a .map, .yaml, .toml or .world file.
        robot: The model that must have room at homes and on the way to goals.
    """
    from pioneer3.sim import map_convert

    findings, code = map_convert.check(file, robot)
    if json:
        write_json({"file": file, "exit_code": code, "remarks": findings}, indent=2)
    else:
        _print_findings(file, findings)
    return code


@map_app.command
def convert(
    source: str,
    target: Path,
    *,
    resolution: Annotated[float, Parameter(validator=Number(gte=0.001, lte=10))] = 0.05,
    force: Flag = False,
) -> int:
    """Write a map in another format; the ending of the new name says which.

    .map for ARIA, .yaml with a .pgm picture for ROS, .toml for a world that builds
    on the map, .svg or .png for a picture to look at.

    Example: pioneer3 map convert office office.yaml

    Args:
        source: A shipped map (office), or a .map, .yaml, .toml or .world file.
        target: The new file.
        resolution: Side of a pixel of a .yaml map [m].
        force: Write over files that are there.
    """
    from pioneer3.sim import map_convert

    done = map_convert.convert(source, target, resolution=resolution, force=force)
    for path in done.files:
        write_line(f"wrote {path}")
    if done.left_out:
        write_line(f"left out, a {target.suffix} has no place for it: {', '.join(done.left_out)}")
    return 0


@map_app.command
def edit(
    file: Path,
    *,
    erase: Boxes = (),
    wall: Lines = (),
    goal: Places = (),
    dock: Places = (),
    home: Places = (),
    forbid_line: Lines = (),
    forbid_area: Boxes = (),
    rename: Annotated[tuple[str, ...], Parameter(metavar="OLD=NEW", negative=())] = (),
    remove: Annotated[tuple[str, ...], Parameter(metavar="NAME", negative=())] = (),
) -> int:
    """Edit walls, places and forbidden areas of a map; the file is written anew.

    Example: pioneer3 map edit lab.map --goal Kitchen=4.4,3.9,90
    Example: pioneer3 map edit lab.map --erase 1.2,0.5,2,1.5

    Args:
        file: A .map or .yaml file.
        erase: x,y,x,y: two corners of a box in which no wall is to be; once for each.
        wall: x,y,x,y: the two ends of a new wall; once for each.
        goal: NAME=x,y or NAME=x,y,heading: a goal, new or moved; once for each.
        dock: The same, a dock with a charger.
        home: The same, where robots begin.
        forbid_line: x,y,x,y: the two ends of a line that robots do not cross; once for each.
        forbid_area: x,y,x,y: two corners of an area that robots do not enter; once for each.
        rename: OLD=NEW: another name for a place, line or area; once for each.
        remove: The name of a place, line or area to remove; once for each.
    """
    from pioneer3.maps import edit, read_map
    from pioneer3.navigation.map_files import save_map

    if file.suffix.lower() == ".toml":
        raise ConfigError(f"{file}: is a world; edit the map that it stands on")
    line_map = read_map(file)
    for box in erase:
        line_map = edit.erased(line_map, _box(box))
    for words in wall:
        line_map = edit.with_wall(line_map, *_ends(words))
    for name in remove:
        line_map = edit.without(line_map, edit.find_object(line_map, name))
    for words in rename:
        old, _, new = words.partition("=")
        line_map = edit.renamed(line_map, edit.find_object(line_map, old), new)
    places: dict[edit.NewRole, Places] = {"goal": goal, "dock": dock, "home": home}
    for role, given in places.items():
        for words in given:
            name, _, place = words.partition("=")
            x, y, *heading = _numbers(words, place, 2, 3)
            line_map = edit.with_place(line_map, role, name, (x, y), *heading)
    for words in forbid_line:
        line_map = edit.with_forbidden(line_map, "line", *_ends(words))
    for words in forbid_area:
        line_map = edit.with_forbidden(line_map, "area", *_ends(words))
    save_map(line_map, file)
    write_line(f"wrote {file}")
    return 0


def _ends(text: str) -> "tuple[tuple[float, float], tuple[float, float]]":
    a, b, c, d = _numbers(text, text, 4, 4)
    return (a, b), (c, d)


def _box(text: str) -> "Extent":
    from pioneer3.maps import Extent

    (a, b), (c, d) = _ends(text)
    return Extent(min(a, c), min(b, d), max(a, c), max(b, d))


def _numbers(text: str, numbers: str, least: int, most: int) -> list[float]:
    """Return the lengths of a list [m], and the heading that is the third of three [rad]."""
    words = numbers.split(",")
    if not least <= len(words) <= most:
        raise ConfigError(f"{text}: expected {'x,y,x,y' if least == 4 else 'NAME=x,y[,heading]'}")
    quantities = [LENGTH, LENGTH, ANGLE if most == 3 else LENGTH, LENGTH]
    try:
        return [quantity.read(word) for quantity, word in zip(quantities, words, strict=False)]
    except ValueError as error:
        raise ConfigError(f"{text}: {error}") from None


def _print_map(info: "MapInfo", console: "Console") -> None:
    from rich.text import Text

    from pioneer3.cli.map_drawing import CharacterCanvas, legend

    title = Text(info.name, "bold", no_wrap=True, overflow="ellipsis")
    width, height = info.size
    title.append(f"  {width:.1f} x {height:.1f} m, {info.walls} walls", "default")
    title.append(f" ({info.wall_length:.0f} m)", "dim")
    counts = Text(", ".join(f"{count} {kind}" for kind, count in info.counts.items()))
    marks = legend(info.drawing.bounds, info.drawing)
    lines = sum(len(text.wrap(console, console.width)) for text in (title, counts, marks))
    # a row for the ruler, and one for the prompt that follows
    canvas = CharacterCanvas(info.drawing, console.width, max(4, console.height - lines - 2))
    console.print(title)
    if counts:
        console.print(counts)
    console.print(canvas.text())
    console.print(canvas.ruler())
    console.print(marks)


def _print_findings(file: str, findings: "tuple[MapProblem, ...]") -> None:
    from rich.text import Text

    from pioneer3.cli.terminal import Terminal

    console = Terminal()
    for finding in findings:
        style = "bold red" if finding.level == "error" else "yellow"
        where = f"{file}:{finding.line}: " if finding.line else f"{file}: "
        text = Text(where).append(f"{finding.level}: ", style).append(finding.text)
        console.print(text, soft_wrap=True)
    if not findings:
        console.print(Text(f"{file}: all fine", "bold green"), soft_wrap=True)
