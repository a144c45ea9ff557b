"""`pioneer3 bridge`."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from cyclopts.validators import Number

from pioneer3.cli.options import PORT, Baud, TcpPort, reads
from pioneer3.cli.process import until_told_to_leave, write_line, write_warning
from pioneer3.errors import ConfigError
from pioneer3.units import DURATION

LOOPBACK = {"127.0.0.1", "::1", "localhost"}
Pause = Annotated[float, reads(DURATION)]
Watchers = Annotated[int, Parameter(validator=Number(gte=0, lte=64))]


@until_told_to_leave
async def bridge(
    *,
    port: Annotated[str, PORT],
    baud: Baud = None,
    bind: str = "127.0.0.1",
    listen: TcpPort = 8101,
    expiry: Pause = 0.5,
    silence: Pause = 1.5,
    watchers: Watchers = 8,
    record: Path | None = None,
) -> int:
    """Let programs on a network reach a robot at a serial port, and stop it safely.

    The first program that connects has the robot; later ones watch, and their stops
    count: pioneer3 fleet stop works while another program drives. ARIA's programs,
    Player's and ours connect as they do to any robot. When the network breaks, the
    robot stops by itself. Ctrl-C, and every signal to leave, stops it first.

    Example: pioneer3 bridge --port /dev/ttyUSB0 --bind 0.0.0.0

    Args:
        port: The robot: /dev/ttyUSB0, tcp://192.168.0.160:8101.
        bind: Address to listen on, such as 0.0.0.0; not 127.0.0.1 lets the network drive.
        listen: TCP port to listen on.
        expiry: The robot stops if the program's computer confirms nothing for so long; 0 for
            never, for networks with longer gaps.
        silence: The robot stops if the program has sent nothing for so long; 0 for never, which
            leaves that to the robot's own watchdog. ARIA's are silent for up to 0.8 s.
        watchers: Most programs that watch.
        record: New file for every byte between the robot and the bridge; replay:FILE plays it.
    """
    import asyncio

    from pioneer3.bridge import Bridge
    from pioneer3.links import opener
    from pioneer3.links.hosts import url_of
    from pioneer3.tasks import running

    for name, value in (("expiry", expiry), ("silence", silence)):
        if value < 0:
            raise ConfigError(f"--{name} {value:g}: it must be 0, or more")
    if bind not in LOOPBACK:
        write_warning(f"there is no password: whoever reaches {bind} can drive this robot")

    made = Bridge(
        opener(port, baud=baud),
        expiry=expiry,
        silence=silence,
        most_watchers=watchers,
        say=write_line,
    )
    if record is not None:
        made.start_recording(record)
    async with running(made.run()), made.listening(bind, listen) as number:
        write_line(f"BRIDGE: {port} on {url_of(bind, number)}")
        await asyncio.get_running_loop().create_future()
    return 0
