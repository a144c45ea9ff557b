"""`pioneer3 class`."""

import os
import sys
from datetime import date
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from cyclopts.validators import Number

from pioneer3.cli.options import AS_SET, Flag, FleetFile, LogOptions, TcpPort, fleet_of
from pioneer3.cli.process import run_until_told_to_leave, write_line
from pioneer3.errors import ConfigError

MOST_STUDENTS = 50


def class_(
    *,
    students: Annotated[
        int | None, Parameter(name=["--students", "-n"], validator=Number(gte=1, lte=MOST_STUDENTS))
    ] = None,
    map_: Annotated[str | None, Parameter(name=["--map", "-m"])] = None,
    robot: Annotated[str, Parameter(name=["--robot", "-r"], metavar="MODEL")] = "p3dx",
    fleet: Annotated[
        FleetFile, Parameter(help="Use the robots of this fleet file in place of simulated ones.")
    ] = None,
    ideal: Flag = False,
    lan: Flag = False,
    log: LogOptions = AS_SET,
    web_port: TcpPort = 8080,
    sim_port: TcpPort = 8101,
    folder: Path | None = None,
    wheelhouse: Annotated[
        Path | bool, Parameter(negative=(), metavar="[DIR]", show_default=False)
    ] = False,
) -> int:
    """Run a class: a robot for each student, and a page for the teacher.

    Example: pioneer3 class --students 20 --lan
    Example: pioneer3 class --students 8 --map lab --robot p3at
    Example: pioneer3 class --students 20 --lan --wheelhouse

    Args:
        students: Number of robots to simulate, one for each student.
        map_: A shipped map or world (office, lab), a .map, map_server .yaml, world .toml, or .world
            or .sdf file of Stage or Gazebo.
        robot: Model of the simulated robots.
        ideal: Simulate without noise and slip: robots do exactly what they are told.
        lan: Let the students' devices in: shows a QR code to scan.
        web_port: TCP port of the page; https takes the next free one with --lan; 0: any free.
        sim_port: TCP port of the first robot for a student's program; 0: free ones.
        folder: Handed-in runs are kept there; else class-DATE in this folder.
        wheelhouse: For laptops without internet: load all that pioneer3 needs into DIR, else into
            the folder wheels, once, and hand it out.
    """
    from pioneer3.fleet.inventory import VARIABLE
    from pioneer3.fleet.reach import given_model, port_of
    from pioneer3.web.classroom.live import ClassOptions, class_live
    from pioneer3.web.hosting import ConnectTarget

    robots: tuple[ConnectTarget, ...] = ()
    if students is not None and fleet is not None and str(fleet) != os.environ.get(VARIABLE):
        raise ConfigError(f"--students {students} simulates robots, --fleet uses others: give one")
    if students is None:
        if fleet is None:
            raise ConfigError("how many students? Say --students 20, or --fleet FILE")
        known = fleet_of(fleet)
        robots = tuple(
            ConnectTarget(
                url=port_of(known, one.name), name=one.name, model=given_model(known, one)
            )
            for one in known.robots
        )
        if not robots:
            raise ConfigError(f"{known.path}: it has no robot; add one as [[robot]]")
    options = ClassOptions(
        students=students or 0,
        fleet=robots,
        map_name=map_,
        model=robot,
        ideal=ideal,
        record=log.where(),
        folder=folder or Path(f"class-{date.today().isoformat()}"),
        sim_port=sim_port,
        web_port=web_port,
        host="0.0.0.0" if lan else "127.0.0.1",
        show_tokens=sys.stdout.isatty(),
        wheelhouse=Path("wheels") if wheelhouse is True else wheelhouse or None,
    )
    return run_until_told_to_leave(class_live(options, write_line))
