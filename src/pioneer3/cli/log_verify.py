"""`pioneer3 log verify`."""

from datetime import UTC, datetime

from pioneer3.cli.options import Flag, LogName, Model
from pioneer3.cli.process import write_json, write_line


def verify(name: LogName = "", /, *, model: Model = None, json: Flag = False) -> int:
    """Run the driver over the bytes of a log, and compare what it sees.

    Each reading of the robot is compared, field by field and bit by bit, and each
    decision is made again of what was wanted then. The first difference is printed,
    and the exit code is 1 then.

    Example: pioneer3 log verify drive

    Args:
        name: A file, or a part of the log's name; without it, the newest.
        model: That was named at the recording of an older log, which does not tell it.
        json: Print JSON.
    """
    from pioneer3.log.folder import named_log_path
    from pioneer3.log.reader import whole_log
    from pioneer3.names import printable
    from pioneer3.runtime.verification import verify as verify_log

    found = verify_log(whole_log(named_log_path(name)), model)
    if json:
        write_json(found)
    for each in () if json else found:
        who = f"{printable(each.robot)}: " if each.robot else ""
        count = (
            f"{who}{each.compared} readings, {each.decisions} decisions"
            f", {each.velocities} velocities, {each.reasons} reasons to stand and"
            f" {each.scans} scans"
        )
        if (first := each.difference) is None:
            write_line(f"{count}, all as recorded")
            continue
        when = datetime.fromtimestamp(first.time / 1e9, UTC).astimezone()
        clock = when.isoformat(sep=" ", timespec="milliseconds")
        write_line(f"{count} as recorded, then a difference at {clock}:")
        write_line(f"  {first.field}: recorded {printable(first.recorded)}")
        write_line(f"  {' ' * len(first.field)}  now      {printable(first.now)}")
    return int(any(each.difference for each in found))
