"""Reads and writes world files: TOML with the tables of :mod:`pioneer3.sim.worldfile.schema`.

An error is one line of text: the file, the line, the key, the problem and a hint.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from difflib import get_close_matches
from os.path import relpath
from pathlib import Path
from typing import Any, TypeVar, get_args, get_type_hints

from pioneer3.errors import ConfigError
from pioneer3.maps import shipped_maps
from pioneer3.maps.materials import Material
from pioneer3.maps.text import decoded, one_line, read_bytes, shown, write_bytes, wrong
from pioneer3.models.toml import load_toml
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.worldfile.spec import Box, Place, RobotSpec, WorldFile

Table = TypeVar("Table")

LARGEST_WORLD = 1 << 20
"""Larger files are not read [bytes]; tomllib takes seconds for them."""
LONGEST_KEY = 40
MODEL_FILES = (".toml", ".p")
KINDS = {"goal": "Goal", "dock": "Dock", "home": "RobotHome"}
"""ARIA's type of the places in each table; a goal with a heading is a GoalWithHeading."""
_ALONE = {"bumpers": "5", "gyro": "1", "table_ir": "new"}
"""Values of the words of `--fit` that may stand without one; a switch is on then."""
_EXAMPLES = {"camera": "vcc4", "laser": "utm-30lx", "laser_port": "10940"}
_EXPECTED = {
    "int": "a whole number",
    "float": "a number",
    "bool": "true or false",
    "str": "a text",
    "object": "a table",
    "array": "two numbers",
}


def is_world(path: Path) -> bool:
    """Whether the name is that of a world file."""
    return path.suffix.lower() == ".toml"


def read_world(path: Path) -> WorldFile:
    """Read a world file; the map it names is read by :meth:`WorldFile.line_map`.

    Raises:
        ConfigError: It cannot be read, or is wrong; names file, line and key.
    """
    return parse_world(path, decoded(read_bytes(path, LARGEST_WORLD)))


def parse_world(path: Path, text: str) -> WorldFile:
    """Read the text of a world file; paths in it are relative to the file's folder.

    Raises:
        ConfigError: It is wrong; names file, line and key.
    """
    from pioneer3.sim.worldfile.schema import FileTable  # imports msgspec

    source = _Source(str(path) if str(path).isprintable() else ascii(str(path)), text)
    try:
        data = load_toml(text)
    except ValueError as error:
        raise wrong(path, f" not valid TOML: {one_line(error)}") from None
    file = _converted(source, data, FileTable)
    robots = tuple(_model_beside(path, table.robot()) for table in file.robot)
    _refuse_doubles(source, robots)
    boxes = tuple(table.box() for table in file.box)
    _refuse_movable_glass(source, boxes)
    tables = {"goal": file.goal, "dock": file.dock, "home": file.home}
    return WorldFile(
        name=path.stem if file.world.name is None else file.world.name,
        map=_map(source, path, file.world.map),
        seed=file.world.seed,
        keep_session=file.world.keep_session,
        robots=robots,
        boxes=boxes,
        walls=tuple(table.wall() for table in file.wall),
        places=tuple(table.place(KINDS[key]) for key in KINDS for table in tables[key]),
        people=tuple(table.person() for table in file.person),
    )


def parse_equipment(text: str) -> EquipmentOptions:
    """Read the value of `--fit`, such as `gripper,gyro=2,camera=vcc4,table-ir=new`.

    Raises:
        ConfigError: A word is unknown, or its value is wrong.
    """
    from pioneer3.sim.worldfile.schema import EquipmentTable  # imports msgspec

    switches = get_type_hints(EquipmentOptions).items()
    alone = {name: "true" for name, kind in switches if kind == bool | None} | _ALONE
    source = _Source("--fit", "")
    said: dict[str, object] = {}
    for word in filter(None, (word.strip() for word in text.split(","))):
        key, equals, value = (part.strip() for part in word.partition("="))
        key = key.replace("-", "_")
        if key in EquipmentTable.__struct_encode_fields__ and not equals and key not in alone:
            value = _EXAMPLES.get(key, "1")
            example = f"{key.replace('_', '-')}={value}"
            raise source.wrong(key, f"needs a value, such as {example}")
        said[key] = _scalar(value if equals else alone.get(key, "true"))
    return _converted(source, said, EquipmentTable).options()


def write_world(world: WorldFile, path: Path) -> None:
    """Write a world file; paths in it are relative to its folder.

    Raises:
        ConfigError: It cannot be written.
    """
    write_bytes(path, to_toml(world, path.parent).encode())


def to_toml(world: WorldFile, folder: Path) -> str:
    """Return the text of a world file that lies in `folder`; defaults are left out."""
    from msgspec import to_builtins

    from pioneer3.sim.worldfile import schema  # imports msgspec

    places = {key: tuple(p for p in world.places if _key(p) == key) for key in KINDS}
    file = schema.FileTable(
        world=schema.WorldTable(
            name=world.name,
            map=_relative(world.map, folder) if isinstance(world.map, Path) else world.map,
            seed=world.seed,
            keep_session=world.keep_session,
        ),
        robot=tuple(schema.RobotTable.of(_relative_model(r, folder)) for r in world.robots),
        box=tuple(map(schema.BoxTable.of, world.boxes)),
        wall=tuple(map(schema.WallTable.of, world.walls)),
        goal=tuple(map(schema.PlaceTable.of, places["goal"])),
        dock=tuple(map(schema.PlaceTable.of, places["dock"])),
        home=tuple(map(schema.PlaceTable.of, places["home"])),
        person=tuple(map(schema.PersonTable.like, world.people)),
    )
    blocks: list[str] = []
    for key, value in to_builtins(file).items():
        heading = f"[{key}]" if isinstance(value, dict) else f"[[{key}]]"
        for table in [value] if isinstance(value, dict) else value:
            entries = (f"{name} = {_written(entry)}\n" for name, entry in table.items())
            blocks.append(f"{heading}\n" + "".join(entries))
    return "\n".join(blocks)


def _map(source: "_Source", path: Path, name: str) -> str | Path:
    if name == "empty" or name in shipped_maps():
        return name
    if is_world(Path(name)):
        problem = f"{shown(name)} is a world too; give a .map or .yaml file"
        raise source.wrong("world.map", problem)
    found = path.parent / name
    try:
        if found.is_file():
            return found
    except (OSError, ValueError):
        pass
    ships = ", ".join((*shipped_maps(), "empty"))
    problem = f"no such file: {shown(name)}, seen from here; there ships {ships}"
    raise source.wrong("world.map", problem)


def _model_beside(path: Path, robot: RobotSpec) -> RobotSpec:
    """Return `robot` with the path of its model's file, which is relative to the world file."""
    is_file = Path(robot.model).suffix.lower() in MODEL_FILES
    return replace(robot, model=str(path.parent / robot.model)) if is_file else robot


def _refuse_doubles(source: "_Source", robots: tuple[RobotSpec, ...]) -> None:
    for key in ("name", "port"):
        seen: dict[object, int] = {}
        for index, robot in enumerate(robots):
            value = robot.name if key == "name" else robot.port
            if value and value in seen:
                problem = f"{value} is robot[{seen[value]}]'s already"
                raise source.wrong(f"robot[{index}].{key}", problem)
            seen[value] = index


def _refuse_movable_glass(source: "_Source", boxes: tuple[Box, ...]) -> None:
    for index, box in enumerate(boxes):
        if box.movable and box.material is Material.GLASS:
            problem = "a movable box is never of glass: take another material, or movable = false"
            raise source.wrong(f"box[{index}].material", problem)


def _scalar(text: str) -> object:
    """Return `text` as TOML would: true or false, a number, else a text."""
    if text in {"true", "false"}:
        return text == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def _key(place: Place) -> str:
    return {"Dock": "dock", "RobotHome": "home"}.get(place.kind, "goal")


def _relative_model(robot: RobotSpec, folder: Path) -> RobotSpec:
    is_file = Path(robot.model).suffix.lower() in MODEL_FILES
    return replace(robot, model=_relative(Path(robot.model), folder)) if is_file else robot


def _relative(path: Path, folder: Path) -> str:
    return path.as_posix() if path.is_absolute() else Path(relpath(path, folder)).as_posix()


def _written(value: object) -> str:
    """Return a value as TOML has it."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_written(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_written, value))}]"
    if isinstance(value, bool):
        return str(value).lower()
    if not isinstance(value, str):
        return repr(value)
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\u{ord(c):04X}" for c in escaped) + '"'


@dataclass(frozen=True, slots=True)
class _Source:
    """The name of a file, and its text, in which the lines of keys are found again."""

    name: str
    text: str

    def wrong(self, place: str, problem: str) -> ConfigError:
        """Return the one-line error about the key at `place`, such as `box[1].size`."""
        line = self._line(place)
        where = f"{self.name}:{line}" if line else self.name
        return ConfigError(f"{where}: {place}: {problem}")

    def _line(self, place: str) -> int | None:
        """Return the line of a key, or of its table; `None` where neither is found."""
        table, _, key = place.partition(".")
        name, _, index = table.rstrip("]").partition("[")
        brackets = r"\[\[\s*{}\s*\]\]" if index else r"\[\s*{}\s*\]"
        heading = re.compile(rf"^\s*{brackets.format(re.escape(name))}\s*(#.*)?$")
        lines = self.text.splitlines()
        heads = [at for at, line in enumerate(lines) if heading.match(line)]
        if int(index or 0) >= len(heads):
            return None
        head = heads[int(index or 0)]
        first = re.split(r"[.\[]", key)[0]
        entry = re.compile(rf"^\s*[\"']?{re.escape(first)}[\"']?\s*=")
        for at in range(head + 1, len(lines)):
            if re.match(r"^\s*\[+\s*[A-Za-z_]", lines[at]):
                break
            if first and entry.match(lines[at]):
                return at + 1
        return head + 1


def _converted(source: _Source, data: dict[str, object], kind: type[Table]) -> Table:
    """Return `data` as the table `kind`.

    Raises:
        ConfigError: A key is missing or unknown, or a value is wrong.
    """
    import msgspec

    if unknown := _unknown_key(source, "", data, kind):
        raise unknown  # here, as msgspec names no place in the topmost table
    try:
        table = msgspec.convert(data, kind)
    except msgspec.ValidationError as error:
        problem, _, path = str(error).rpartition(" - at `$")
        place = path.rstrip("`").lstrip(".") if problem else ""
        raise _complaint(source, data, kind, place, problem or str(error)) from None
    for place, text in _texts(msgspec.to_builtins(table)):
        if not text.isprintable():
            raise source.wrong(place, f"{shown(text)} cannot be printed on one line")
    return table


def _complaint(
    source: _Source, data: dict[str, object], kind: type, place: str, problem: str
) -> ConfigError:
    """Return msgspec's `problem` with the key at `place` in the words of a person."""
    value: Any = data
    hint: Any = kind
    for part in re.findall(r"\w+", place):
        value = value[int(part) if part.isdecimal() else part]
        if not part.isdecimal():
            hint = _keys(hint)[part]
    if problem.startswith("Object") and (unknown := _unknown_key(source, place, value, hint)):
        return unknown
    if missing := re.match(r"Object missing required field `(\w+)`", problem):
        if missing[1] == "world":
            return ConfigError(f"{source.name}: world: missing; a world starts with [world]")
        return source.wrong(f"{place}.{missing[1]}".lstrip("."), "missing, add it")
    return source.wrong(place, _misfit(place, value, hint, problem))


def _unknown_key(
    source: _Source, place: str, table: dict[str, object], hint: object
) -> ConfigError | None:
    """Return the error about the first unknown key of a table, if there is one."""
    known = _keys(hint)
    key = next((key for key in table if key not in known), None)
    if key is None:
        return None
    close = get_close_matches(key[:LONGEST_KEY], known, n=1)
    advice = f"did you mean {close[0]}?" if close else f"known are {', '.join(known)}"
    named = key if key.isprintable() and 0 < len(key) <= LONGEST_KEY else shown(key)
    return source.wrong(f"{place}.{named}" if place else named, f"unknown key, {advice}")


def _misfit(place: str, value: object, hint: object, problem: str) -> str:
    """Return the problem of a value, and the expected ones."""
    if place.endswith(".start"):
        return 'expected {x, y, theta_deg} or "random" or "outside" or "home"'
    if problem.startswith("Invalid enum value"):
        choices = [part for part in _parts(hint) if isinstance(part, str)]
        return f"{shown(str(value))} is none of {', '.join(choices)}"
    if re.match(r"Expected `\w+` [<>]=|Number out of range", problem):
        low, high = next((p.ge, p.le) for p in _parts(hint) if getattr(p, "ge", None) is not None)
        return f"{_said(value)} is out of range, expected {low:g} to {high:g}"
    if problem.startswith("Expected `array") and place.isidentifier():
        return f"expected [[{place}]], with two brackets"
    expected = _EXPECTED[re.split(r"[` ]+", problem)[1]]
    least = next((p.min_length for p in _parts(hint) if getattr(p, "min_length", None)), None)
    if least and not place.endswith("]"):
        expected = f"a list of {least} or more points [x, y]"
    return f"expected {expected}, got {_said(value)}"


def _parts(hint: Any) -> Iterator[Any]:
    """Yield a type hint and all that it is made of."""
    yield hint
    for part in (*getattr(hint, "__metadata__", ()), *get_args(hint)):
        yield from _parts(part)


def _keys(hint: Any) -> dict[str, Any]:
    """Return the keys of the table that a type hint names, and the hint of each."""
    table = next(part for part in _parts(hint) if hasattr(part, "__struct_fields__"))
    hints = get_type_hints(table, include_extras=True)
    names = zip(table.__struct_encode_fields__, table.__struct_fields__, strict=True)
    return {key: hints[name] for key, name in names}


def _texts(value: object, place: str = "") -> Iterator[tuple[str, str]]:
    """Yield every text in `value` with its place."""
    if isinstance(value, str):
        yield place, value
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from _texts(item, f"{place}.{key}" if place else key)
    elif isinstance(value, list | tuple):
        for index, item in enumerate(value):
            yield from _texts(item, f"{place}[{index}]")


def _said(value: object) -> str:
    """Return `value` for a message; deep and long ones cut short."""
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list):
        return f"a list of {len(value)}"
    if isinstance(value, int) and value.bit_length() > 128:
        return "a huge number"
    if isinstance(value, str):
        return shown(value)
    return str(value) if isinstance(value, bool) or not isinstance(value, float) else f"{value:g}"
