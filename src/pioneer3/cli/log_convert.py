"""`pioneer3 log convert`: the messages of a log for other programs."""

import re
from pathlib import Path
from typing import Annotated, Literal, get_args

from cyclopts import Parameter

from pioneer3.cli.options import LogName
from pioneer3.cli.process import busy_sign, write_line, write_warning
from pioneer3.errors import ConfigError

Kind = Literal["rosbag2", "rosbag1", "csv", "parquet"]
"""Kind of what is made of a log."""
Profile = Literal["compatibility", "standard", "both", "p2os"]
"""Which names topics have in ROS 1."""
BAG = ".bag"
"""Ending of ROS 1's bags."""
LAST_WORD = re.compile(r"[a-z0-9]+$")
"""The end of a name that may tell the kind."""


def convert(
    name: LogName = "",
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    to: Kind | None = None,
    profile: Profile = "compatibility",
    model: Annotated[str | None, Parameter(metavar="NAME|FILE")] = None,
) -> int:
    """Write a log for other programs: as a rosbag, or as tables.

    rosbag2 is a folder with MCAP, rosbag1 a .bag file: with the topics, types,
    frames and stamps of the nodes of ros2 and ros1. csv and parquet are folders
    with a table for each topic of the log, units in the heads of its columns.

    Example: pioneer3 log convert drive -o drive.bag
    Example: pioneer3 log convert drive --to rosbag2 -o drive
    Example: pioneer3 log convert drive -o drive-csv

    Args:
        name: A file, or a part of the log's name; without it, the newest.
        output: The new file or folder.
        to: What to make; without it, what the end of the new name says.
        profile: Names of topics in ROS 1, as of the node.
        model: Of the robot, such as p3dx-sh, or a .toml or ARIA .p file; else as the log says.
    """
    from pioneer3.log.folder import named_log_path
    from pioneer3.log.reader import whole_log

    kind = to or kind_of(output)
    log = whole_log(named_log_path(name))
    with busy_sign(f"reading {log.path}") as tell:

        def progress(share: float) -> None:
            tell(f"converting {log.path}: {100 * share:.0f} %")

        if kind in {"csv", "parquet"}:
            from pioneer3.log.tables import TableKind, write_tables

            counts = write_tables(log, output, TableKind(kind), tell=progress)
        else:
            from pioneer3.ros.bag.convert import BagKind, write_bag
            from pioneer3.ros.node.names import Profile as Names

            bag, names = BagKind(kind), Names(profile) if kind == "rosbag1" else Names.ROS2
            written = write_bag(log, output, bag, names, model=model, tell=progress)
            counts = written.counts
            for warning in written.warnings:
                write_warning(warning)
    write_line(f"{output}: {sum(counts.values())} messages of {len(counts)} topics")
    return 0


def kind_of(output: Path) -> Kind:
    """Return the kind of output that the end of a name stands for.

    Raises:
        ConfigError: It says nothing.
    """
    if output.suffix.lower() == BAG:
        return "rosbag1"
    last = LAST_WORD.search(output.name.lower())
    for kind in get_args(Kind):
        if last and last[0] == kind:
            return kind  # type: ignore[no-any-return]
    raise ConfigError(f"{output}: the name does not say what to make: add --to rosbag2, or another")
