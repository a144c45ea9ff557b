"""Work on many computers at once: none waits for another, and none is waited for too long."""

import asyncio
import logging
import re
import shlex
from collections.abc import Awaitable, Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Any, Final

from pioneer3.doctor.facts import FAILED, UNREACHABLE
from pioneer3.errors import HostError, RemoteError
from pioneer3.fleet.spec import FleetRobot
from pioneer3.fleet.ssh import LOGIN, Login, asyncssh_module, connect
from pioneer3.names import printable

if TYPE_CHECKING:
    import asyncssh

    from pioneer3.fleet.stop import Stopped

log = logging.getLogger(__name__)

LONGEST_LINE: Final = 16_384
"""A longer line is shown in pieces [characters]."""
LONGEST_ANSWER: Final = 16e6
"""Most output that is kept of a remote command [characters]."""
ENDING: Final = 4.0
"""Time for a remote command to end when it is told to [s]."""
KILL_AFTER: Final = 2
"""A remote command that ignores SIGTERM is killed after this time [s]."""
_BEGIN: Final = "pioneer3: the answer"
"""Lines that the start-up files of shells print before this one are no answer."""
_LINE_ENDS: Final = re.compile(r"\r\n|\n|\r(?!\Z)")
"""A carriage return at the end may be half of one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Done:
    """The end of the work on one computer: its exit status, and a word about it."""

    status: int = 0
    said: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """The result of the work on one computer: whether we were logged in, and all went well.

    `why` is the reason for a failure, and the next step; else a word about the result. The exit
    status there is `None` if there was none.
    """

    robot: str
    ok: bool
    reached: bool
    status: int | None
    why: str
    seconds: float


Work = Callable[[FleetRobot], Awaitable[Done]]
Show = Callable[[FleetRobot, str, bool], None]
"""Takes a robot, a line of output, and whether it is of standard error."""


async def on_each(robots: Iterable[FleetRobot], work: Work) -> tuple[Outcome, ...]:
    """Do `work` for all robots at once; return the outcomes in the order of `robots`."""
    async with asyncio.TaskGroup() as group:
        tasks = [group.create_task(_outcome(robot, work)) for robot in robots]
    return tuple(task.result() for task in tasks)


async def _outcome(robot: FleetRobot, work: Work) -> Outcome:
    clock = asyncio.get_running_loop().time
    began = clock()
    reached, status = True, None
    try:
        done = await work(robot)
        ok, status, why = done.status == 0, done.status, done.said
    except HostError as error:
        ok, reached, why = False, False, str(error)
    except RemoteError as error:
        ok, why = False, str(error)
    except Exception as error:  # the others go on
        log.exception("the work on %s failed", robot.name)
        ok, why = False, f"a fault of this program: {error!r}"
    return Outcome(
        robot=robot.name,
        ok=ok,
        reached=reached,
        status=status,
        why=printable(why),
        seconds=clock() - began,
    )


def exit_code(outcomes: "Sequence[Outcome | Stopped]") -> int:
    """Return 0 if all went well, 3 if nobody was reached, else 1."""
    if all(each.ok for each in outcomes):
        return 0
    return FAILED if any(each.reached for each in outcomes) else UNREACHABLE


async def run_on(
    robots: Iterable[FleetRobot],
    command: str,
    show: Show,
    *,
    login: Login = LOGIN,
    limit: float | None = None,
) -> tuple[Outcome, ...]:
    """Run a command of the user's shell on all computers at once; `show` takes lines as they come.

    It ends with this call, also if that is cancelled, with the connection, and at a limit [s].
    """

    async def work(robot: FleetRobot) -> Done:
        async with connect(robot, login) as connection:
            return await run_command(
                connection, command, lambda line, err: show(robot, line, err), limit=limit
            )

    return await on_each(robots, work)


async def run_command(
    connection: "asyncssh.SSHClientConnection",
    command: str,
    show: Callable[[str, bool], None],
    *,
    limit: float | None = None,
    longest: float = inf,
) -> Done:
    """Run one command over an open connection; it ends with this call.

    Raises:
        HostError: The connection was lost.
        RemoteError: The command took longer than `limit` [s], or wrote more than `longest`
            characters; or the shell could not be started.
    """
    left = longest

    def take(line: str, is_error: bool) -> None:
        nonlocal left
        left -= len(line) + 1
        if left < 0:
            raise RemoteError(
                f"stopped: it wrote more than {longest / 1e6:g} MB, much too much for an answer; "
                "look at the start-up files of the shell there, such as ~/.bashrc"
            )
        show(line, is_error)

    ssh = asyncssh_module()
    try:
        process = await connection.create_process(bound_to_stdin(command), errors="replace")
    except ssh.ChannelOpenError as error:
        raise RemoteError(f"no shell is to be had there: {error}") from None
    try:
        async with asyncio.timeout(limit) as timeout:
            await asyncio.gather(
                _lines(process.stdout, lambda line: take(line, False)),
                _lines(process.stderr, lambda line: take(line, True)),
            )
    except TimeoutError:
        await _end(process)
        if not timeout.expired():
            raise
        raise RemoteError(f"stopped: it took longer than {limit:g} s") from None
    except (asyncio.CancelledError, RemoteError):
        await _end(process)
        raise
    await process.wait_closed()
    return _done(process)


def _done(process: Any) -> Done:
    if process.exit_signal is not None:
        return Done(status=128, said=f"ended by SIG{process.exit_signal[0]}")
    if process.exit_status is None:
        raise ConnectionAbortedError("the connection was lost")  # `connect` tells it in words
    status = int(process.exit_status)
    return Done(status=status, said="" if status == 0 else f"exit status {status}")


async def output_of(connection: "asyncssh.SSHClientConnection", command: str) -> str:
    """Return the output of a short command for `sh`, without the lines that a login there prints.

    Raises:
        HostError: The connection was lost.
        RemoteError: The command failed; with its words. Or it wrote too much.
    """
    out: list[str] = []
    err: list[str] = []
    done = await run_command(
        connection,
        f"exec sh -c {shlex.quote(f'cd; echo {_BEGIN}; {command}')}",
        lambda line, is_error: (err if is_error else out).append(line),
        longest=LONGEST_ANSWER,
    )
    if done.status:
        raise RemoteError("; ".join(err[-3:]) or done.said)
    return "\n".join(out[out.index(_BEGIN) + 1 :] if _BEGIN in out else out)


def bound_to_stdin(command: str) -> str:
    """Return a command line that runs `command`, and ends it when standard input ends.

    Without a terminal sshd lets a command go on when its connection ends.
    """
    script = (
        'exec 3<&0; setsid "${SHELL:-sh}" -c "$1" </dev/null 3<&- & c=$!; '
        f"(cat <&3; kill -TERM -$c; sleep {KILL_AFTER}; kill -KILL -$c) >/dev/null 2>&1 & w=$!; "
        "exec 3<&-; wait $c; s=$?; kill $w 2>/dev/null; exit $s"
    )
    return f"exec sh -c {shlex.quote(script)} sh {shlex.quote(command)}"


async def _end(process: Any) -> None:
    """End a remote command, if its connection still lives."""
    ssh = asyncssh_module()
    with suppress(TimeoutError, OSError, ssh.Error):
        async with asyncio.timeout(ENDING):
            process.stdin.write_eof()
            await asyncio.gather(_dropped(process.stdout), _dropped(process.stderr))
            await process.wait_closed()


async def _dropped(reader: Any) -> None:
    while await _read(reader):
        pass


async def _lines(reader: Any, show: Callable[[str], None]) -> None:
    rest = ""
    while text := await _read(reader):
        *lines, rest = _LINE_ENDS.split(rest + text)
        for line in lines:
            show(line)
        if len(rest) >= LONGEST_LINE:
            show(rest)
            rest = ""
    if rest:
        show(rest.rstrip("\r"))


async def _read(reader: Any) -> str:
    """Return some output; empty at its end, and at that of the connection."""
    try:
        return str(await reader.read(LONGEST_LINE))
    except (OSError, asyncssh_module().Error):
        return ""
