"""`pioneer3 replay`."""

import sys
from typing import Annotated

from cyclopts import Parameter

from pioneer3.cli.options import Flag, TcpPort
from pioneer3.cli.process import run_until_told_to_leave, write_line


def replay(
    *names: Annotated[str, Parameter(metavar="LOG")], web_port: TcpPort = 8080, lan: Flag = False
) -> int:
    """Show a log on the page as if it were live; nothing in it can be driven.

    Robots of several logs stand beside each other, by the clock of their computers.

    Example: pioneer3 replay
    Example: pioneer3 replay drive
    Example: pioneer3 replay alice.mcap bob.mcap

    Args:
        names: Files, or parts of the logs' names; without one, the newest log.
        web_port: TCP port of the page; 0: any free.
        lan: Let other devices in, who must pair first: shows a QR code to scan.
    """
    from pioneer3.log.folder import named_log_path
    from pioneer3.web.replay.live import replay as serve

    serving = serve(
        [named_log_path(each) for each in names or ("",)],
        write_line,
        port=web_port,
        host="0.0.0.0" if lan else "127.0.0.1",
        show_tokens=sys.stdout.isatty(),
    )
    return run_until_told_to_leave(serving)
