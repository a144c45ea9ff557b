"""`pioneer3 log`: what robots did, as their logs have it."""

from contextlib import suppress
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import App, Parameter

from pioneer3.cli.log_convert import convert
from pioneer3.cli.log_plot import plot
from pioneer3.cli.log_stats import stats
from pioneer3.cli.log_verify import verify
from pioneer3.cli.log_why import why
from pioneer3.cli.options import Flag, LogName
from pioneer3.cli.process import write_json, write_line, write_warning
from pioneer3.errors import ConfigError

if TYPE_CHECKING:
    from pioneer3.log.reader import LogInfo

log_app = App(
    name="log",
    help="""Look at what robots did: each program that drives one writes a log.

    A log is a file, or the newest with such a part in its name; without one, the
    newest of all.

    Example: pioneer3 log list
    Example: pioneer3 log why --at 14:02:31
    Example: pioneer3 log info drive
    """,
)
log_app.command(convert)
log_app.command(verify)
log_app.command(why)
log_app.command(plot)
log_app.command(stats)
Moment = Annotated[str | None, Parameter(metavar="TIME", show_default=False)]


@log_app.command
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


@log_app.command(name="map")
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


@log_app.command(name="list")
def list_(*, json: Flag = False) -> int:
    """List the logs, the newest last, with how long they are and why they ended.

    Example: pioneer3 log list

    Args:
        json: Print JSON.
    """
    from rich.table import Table

    from pioneer3.cli.terminal import Terminal
    from pioneer3.log.folder import is_being_written, logs_folder, user_logs
    from pioneer3.log.reader import whole_logs
    from pioneer3.names import printable

    filled, empty = list[Path](), 0
    for path in user_logs(logs_folder()):
        with suppress(OSError):  # it has gone just now
            if path.stat().st_size:
                filled.append(path)
            elif not is_being_written(path):  # else its program has just begun
                empty += 1
    found = [*whole_logs(filled, lambda error: write_warning(str(error)))]
    if empty:
        logs = "1 log is" if empty == 1 else f"{empty} logs are"
        write_warning(f"{logs} empty: killed, without power, or without room on the disk")
    if json:
        write_json([_facts(info) for info in found])
        return 0
    if not found:
        write_line(f"No logs in {logs_folder()}.")
        return 0
    table = Table(box=None, pad_edge=False, padding=(0, 1, 0, 0), header_style="bold")
    table.add_column("name (begin in UTC)", no_wrap=True)
    for heading in ("long", "robot", "end", "size", ""):
        table.add_column(heading, overflow="fold")
    for info in found:
        table.add_row(
            info.path.stem,
            _length(info.seconds),
            printable(info.robot),
            printable(info.end),
            _size(info.size),
            "pinned" if info.pinned else "",
        )
    Terminal().print(table)
    return 0


@log_app.command
def info(name: LogName = "", /, *, json: Flag = False) -> int:
    """Show what a log has: what was started, the robot, the messages by topic.

    Example: pioneer3 log info drive

    Args:
        name: A file, or a part of the log's name; without it, the newest.
        json: Print JSON.
    """
    from pioneer3.log.folder import named_log_path
    from pioneer3.log.reader import whole_log
    from pioneer3.names import printable

    known = whole_log(named_log_path(name)).info()
    if json:
        write_json(_facts(known))
        return 0
    rows = {
        "file": str(known.path),
        "command": known.command,
        "began": _local(known.began),
        "long": _length(known.seconds),
        "end": known.end,
        "size": _size(known.size) + (", pinned" if known.pinned else ""),
    }
    if rest := known.files[1:]:
        rows["goes on in"] = ", ".join(each.name for each in rest)
    if known.gaps:
        rows["lacks"] = ", ".join(map(_gap, known.gaps)) + ": files that have gone"
    for about, texts in known.texts.items():
        if about.endswith("robot"):
            keys = ("name", "model", "kind", "url")
            rows[about] = ", ".join(texts[key] for key in keys if texts.get(key))
    if note := known.texts.get("note"):
        rows["note"] = f"{note.get('text', '')} ({note.get('by', '')})"
    counts = known.counts or {}
    width = max(map(len, [*rows, *(f"  {topic}" for topic in counts)]))
    lines = [*rows.items(), *[("messages", "")] * bool(counts)]
    lines += [(f"  {topic}", str(number)) for topic, number in sorted(counts.items())]
    for label, text in lines:
        write_line(f"{printable(label):{width}}  {printable(text)}".rstrip())
    if known.counts is None:
        end = "The end of a file" if rest else "Its end"
        write_line(f"{end} is missing: it was not counted. Everything before can be read.")
    return 0


@log_app.command
def pin(name: Annotated[str, Parameter(metavar="LOG")], /, *, off: Flag = False) -> int:
    """Keep all files of a log until you remove them, whatever room others need.

    Example: pioneer3 log pin drive

    Args:
        name: Of the log, which is among the user's: no other file is changed.
        off: Let it go when room is needed.
    """
    from pioneer3.log.folder import find_log, logs_folder, user_logs
    from pioneer3.log.folder import pin as set_pin
    from pioneer3.log.reader import whole_log

    path = find_log(logs_folder(), Path(name).name)
    try:
        files = {*whole_log(path).files}
    except ConfigError:  # a damaged one may be kept, too
        files = {path}
    for each in user_logs(logs_folder()):
        if each not in files:
            continue
        try:
            set_pin(each, on=not off)
        except OSError as error:
            raise ConfigError(f"{each}: cannot be changed: {error.strerror}") from None
        write_line(f"{each}: {'goes when room is needed' if off else 'is kept'}")
    return 0


@log_app.command
def cut(
    name: LogName = "",
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    begin: Moment = None,
    end: Moment = None,
) -> int:
    """Write a part of a log to a new file.

    Example: pioneer3 log cut drive --begin 14:02:10 --end 14:03:00 -o stall.mcap
    Example: pioneer3 log cut drive --begin 90s --end 2min -o stall.mcap

    Args:
        name: A file, or a part of the log's name; without it, the newest.
        output: The new file.
        begin: A time of day, or how long after the log began.
        end: Likewise.
    """
    from pioneer3.log.excerpt import write_excerpt
    from pioneer3.log.folder import named_log_path
    from pioneer3.log.index import LogIndex
    from pioneer3.log.reader import whole_log

    log = LogIndex(*whole_log(named_log_path(name)).files)
    known = log.info()
    first = known.began if begin is None else _moment("begin", begin, known)
    last = known.ended if end is None else _moment("end", end, known)
    written = write_excerpt(log, output, first, last)
    write_line(f"{output}: {written} messages of {_length((last - first) / 1e9)}")
    return 0


def _moment(option: str, text: str, known: "LogInfo") -> int:
    """Return a time of a log [ns since 1970]."""
    from pioneer3.log.moment import time_of

    try:
        return time_of(text, known.began)
    except ConfigError as error:
        raise ConfigError(f"--{option} {error}") from None


def _gap(times: tuple[int, int]) -> str:
    begin, end = (datetime.fromtimestamp(each / 1e9) for each in times)
    return f"{begin:%H:%M:%S} to {end:%H:%M:%S}"


def _facts(known: "LogInfo") -> dict[str, object]:
    return {
        "file": str(known.path),
        "files": [str(path) for path in known.files],
        "gaps": [[begin / 1e9, end / 1e9] for begin, end in known.gaps],
        "command": known.command,
        "robot": known.robot,
        "began": known.began / 1e9,
        "seconds": known.seconds,
        "end": known.end,
        "size": known.size,
        "pinned": known.pinned,
        "messages": known.counts,
    }


def _local(time: int) -> str:
    return datetime.fromtimestamp(time / 1e9).astimezone().strftime("%Y-%m-%d %H:%M:%S")


def _length(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"


def _size(size: int) -> str:
    return f"{size / 1e6:.1f} MB" if size >= 1e5 else f"{size / 1e3:.0f} kB"
