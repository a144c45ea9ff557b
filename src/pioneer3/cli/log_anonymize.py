"""`pioneer3 log anonymize`: a log without names, to be given away."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from pioneer3.cli.options import LogName
from pioneer3.cli.process import write_line


def anonymize(
    name: LogName = "",
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"], metavar="FILE")],
) -> int:
    """Write a log without names of robots, people, hosts, places and files.

    Numbers stay: readings, times, the map's walls. Bytes of lasers are left out.

    Example: pioneer3 log anonymize drive -o anonymous.mcap

    Args:
        name: A file, or a part of the log's name; without it, the newest.
        output: The new file.
    """
    from pioneer3.analysis.anonymous import write_anonymous
    from pioneer3.log import open as open_log

    written = write_anonymous(open_log(name), output)
    write_line(f"{output}: {written} messages; look at it before you give it away")
    return 0
