"""Logs of what a robot did: written beside the driver, never in its way, and read again.

============  =================================================================================
module        contents
============  =================================================================================
topics        the messages of a log, as bytes and back, exactly
scans         scans as bytes and back, exactly
writer        takes messages from the event loop, and writes them in a thread
target        opens the files of a log: one that is named, or the next ones of the user's folder
folder        the user's logs: their names, which go first, which are pinned or being written
mcap          one MCAP file while it is written: chunks, flushes, its end
reader        reads a log, with or without its end, and its index
command_line  the command that was started, without secrets
excerpt       a part of a log, as a log of its own
cut           MCAP files without an end
============  =================================================================================
"""
