"""`pioneer3 log map`: the map of a run."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from pioneer3.cli.options import Flag, LogName


def map_(
    name: LogName = "",
    /,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"], metavar="FILE")] = None,
    repair_odometry: Flag = False,
    force: Flag = False,
) -> int:
    """Make a map of what the laser saw in a run, as `map build --from` does.

    Example: pioneer3 log map drive

    Args:
        name: A file, or a part of the log's name; without it, the newest.
        output: The new map: .map, .yaml or .toml. Without it a .map named after the time.
        repair_odometry: Trust the scans where odometry contradicts them.
        force: Write over files that are there.
    """
    from pioneer3.cli.map_build import build
    from pioneer3.log.folder import named_log_path

    return build(
        output=output, from_=named_log_path(name), repair_odometry=repair_odometry, force=force
    )
