"""Logs of what a robot did: written beside the driver, never in its way, and read again.

Programs read one by :func:`open`.

============  =================================================================================
module        contents
============  =================================================================================
topics        the messages of a log, as bytes and back, exactly
scans         scans as bytes and back, exactly
rows          snapshots and scans as columns and back, exactly
differences   bytes as differences and in planes, which take less room
writer        takes messages from the event loop, and writes them in a thread
target        opens the files of a log: one that is named, or the next ones of the user's folder
folder        the user's logs: their names, which go first, which are pinned or being written
mcap          one MCAP file while it is written: chunks, flushes, its end
chunks        finds the chunks of a file, and reads the messages in them
reader        reads a log, with or without its end
index         finds the messages of a log at any time
progress      the progress of reading a log
output        outputs that are whole or not there
columns       columns of a table of messages
tables        tables of a log, one a topic
csv_file      a table as comma-separated values
parquet_file  a table as Parquet
command_line  the command that was started, without secrets
moment        times in a log, as people tell them
excerpt       a part of a log, as a log of its own
cut           MCAP files without an end
============  =================================================================================
"""

TYPE_CHECKING = False  # as in the package above: the module typing takes a while

if TYPE_CHECKING:
    from pioneer3.analysis.open_log import OpenLog
    from pioneer3.analysis.open_log import open_log as open  # noqa: A004

_HOME = {"OpenLog": "OpenLog", "open": "open_log"}
__all__ = ["OpenLog", "open"]


def __getattr__(name: str) -> object:
    """Import public names when they are first used (PEP 562)."""
    from importlib import import_module

    if name not in _HOME:
        raise AttributeError(f"module 'pioneer3.log' has no attribute {name!r}")
    return getattr(import_module("pioneer3.analysis.open_log"), _HOME[name])
