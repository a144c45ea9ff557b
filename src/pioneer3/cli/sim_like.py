"""Finds the robot that `pioneer3 sim --like` is to simulate: of its own file, or of a log."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields
from math import degrees
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Final

from pioneer3.cli.process import write_line
from pioneer3.errors import ConfigError

if TYPE_CHECKING:
    from rich.table import Table

    from pioneer3.analysis.twin import FittedTwin, Likeness
    from pioneer3.models.model import OwnFile
    from pioneer3.sim.realism import Realism
    from pioneer3.sim.worldfile import RobotSpec

AGREES: Final = "it ended where 19 of 20 runs of its twin end"
"""In words, if the twin is like it."""
DIFFERS: Final = "it did not end where its twin does: it slipped, was pushed, or was held up"
"""In words, if not."""
UNTOLD: Final = "what the table does not have is as usual"
"""The parts of a twin that are not the robot's."""


@dataclass(frozen=True, slots=True)
class Like:
    """A robot to simulate, its errors, and the time from a command to its report [s]."""

    robot: "RobotSpec"
    realism: "Realism"
    delay: float = 0.0


@contextmanager
def robot_like(name: str, realism: "Realism", against: str | None = None) -> Iterator[Like]:
    """Find the robot that a file or a name tells of; print what a log tells.

    Args:
        name: A robot's own file, a robot that has one, a log, or a part of a log's name.
        realism: Errors of what is not told.
        against: Another log of the robot, which the twin is compared with in place of its own.

    Raises:
        ConfigError: There is no such robot or log, or it is wrong, or tells too little.
        PortNotFoundError: There is no such log.
    """
    from pioneer3.models.own import ARIA, TOML, path_of

    path = path_of((name,)) or Path(name)
    if path.suffix.lower() in {TOML, ARIA}:
        if against is not None:
            raise ConfigError(f"--against {against}: of a twin by a log; {path} is none")
        yield _of_own_file(path, realism)
        return
    with TemporaryDirectory(prefix="pioneer3-") as folder:
        yield _of_log(name, Path(folder), realism, against)


def _of_own_file(path: Path, realism: "Realism") -> Like:
    from pioneer3.models.own import read_own
    from pioneer3.sim.equipment import EquipmentOptions
    from pioneer3.sim.worldfile import RobotSpec

    own = read_own(path)
    laser = _laser(own)
    return Like(
        RobotSpec(model=str(path), name=path.stem, equipment=EquipmentOptions(laser=laser)), realism
    )


def _laser(own: "OwnFile") -> str | None:
    """Return the name of the robot's first laser, if there is a simulated one of its kind."""
    from pioneer3.models.lasers import load_laser

    if not own.lasers:
        return None
    try:
        return load_laser(own.lasers[0].mount.kind).name
    except ConfigError:
        return None


def _of_log(name: str, folder: Path, realism: "Realism", against: str | None) -> Like:
    from pioneer3.analysis.open_log import open_log
    from pioneer3.analysis.twin import likeness, read_drive, twin_of
    from pioneer3.cli.terminal import Terminal
    from pioneer3.sim.worldfile import RobotSpec
    from pioneer3.tables import table_of, written

    drive = read_drive(open_log(name))
    twin = twin_of(drive)
    write_line(
        f"{drive.log.path.name}: a {drive.model.title}, from {twin.pieces} pieces of its drive"
    )
    Terminal().print(_ratios(twin))
    alike = likeness(read_drive(open_log(against)) if against else drive, twin)
    Terminal().print(_ends(alike))
    write_line(AGREES if alike.agrees else DIFFERS)
    write_line(UNTOLD)
    own = folder / "twin.toml"
    text = f'like = "{drive.model.name}"\n\n{written({"odometry": table_of(twin.model.odometry)})}'
    own.write_text(text, encoding="utf-8")
    return Like(RobotSpec(model=str(own)), twin.realism(realism), twin.delay or 0.0)


def _ratios(twin: "FittedTwin") -> "Table":
    """Return the errors of the odometry, and how sure they are."""
    table = _table("odometry", "value", "standard error", "")
    for field, unsure in zip(fields(twin.model.odometry), twin.unsure, strict=True):
        value = getattr(twin.model.odometry, field.name)
        told = "" if abs(value - 1) > 2 * unsure else "no better than chance"
        table.add_row(field.name, f"{value:.4f}", f"{unsure:.4f}", told)
    table.add_row("noise", f"{twin.noise:.2f}", "", "times the usual")
    if twin.sonar_noise is not None:
        table.add_row("sonar noise", f"{100 * twin.sonar_noise:.2f} %", "", "of the range")
    if twin.laser_noise is not None:
        table.add_row("laser noise", f"{1000 * twin.laser_noise:.1f} mm")
    if twin.delay is not None:
        table.add_row("delay", f"{1000 * twin.delay:.0f} ms", "", "from a command to its report")
    return table


def _ends(alike: "Likeness") -> "Table":
    """Return where the drive ended, seen from its start, and where the twin's runs did."""
    from rich.text import Text

    table = _table("end of the drive", "robot", f"{len(alike.runs)} runs of its twin")
    rows = zip(("x [m]", "y [m]", "heading [deg]"), *alike.columns, strict=True)
    for name, robot, mean, spread in rows:
        unit = degrees(1) if "deg" in name else 1.0
        runs = f"{mean * unit:.2f} ± {spread * unit:.2f}"
        table.add_row(Text(name), f"{robot * unit:.2f}", runs)
    return table


def _table(*headings: str) -> "Table":
    from rich.table import Table

    table = Table(box=None, pad_edge=False, header_style="bold")
    for number, heading in enumerate(headings):
        table.add_column(heading, no_wrap=True, justify="right" if number in {1, 2} else "left")
    return table
