"""Every way out of a program tells the robot to stop: the bytes are counted at the other end."""

import asyncio
import os
import re
import signal
import sys
import textwrap
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest

from pioneer3 import connect_async
from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.packet import PacketReader
from pioneer3.links.stream import accepted
from pioneer3.models import load_model
from pioneer3.runtime.signals import StopOnSignals
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.server import Simulation
from pioneer3.sim.world import World
from tests.support import SimulatedRobot, frame, hold, until

FAREWELL: list[Command] = [
    commands.Stop(),
    commands.Enable(on=False),
    commands.Sonar(on=False),
    commands.Close(),
]
BYE = b"".join(frame(command) for command in FAREWELL)
SOON = 20.0  # of a busy machine
AS_IN_THE_FOREGROUND = """
import resource, signal
signal.signal(signal.SIGINT, signal.default_int_handler)
for number in (signal.SIGHUP, signal.SIGQUIT):
    signal.signal(number, signal.SIG_DFL)
resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
"""
"""A shell's background jobs ignore signals, and pass that on; nobody wants the core of SIGQUIT."""
RARE = [signal.SIGHUP, signal.SIGQUIT]
SIGNALS = [signal.SIGINT, signal.SIGTERM, *RARE]
SIGNALS_AT_LENGTH = [
    signal.SIGINT,
    signal.SIGTERM,
    *(pytest.param(sent, marks=pytest.mark.thorough) for sent in RARE),
]
"""The rare ones take the way of SIGTERM; once for each kind of program is for the thorough tier."""
SLOW = re.compile(r"^Executing <.* took [\d.]+ seconds\n", re.MULTILINE)
"""What asyncio, debugged, remarks on a busy machine."""


class Recorded(Firmware):
    """A firmware that keeps what it hears."""

    heard = b""

    def receive(self, data: bytes, now: float) -> None:
        self.heard += data
        super().receive(data, now)


class Site:
    """A simulator in this process, and a program beside it."""

    def __init__(self, simulation: Simulation, firmware: Recorded, body: Body) -> None:
        self.simulation, self.firmware, self.body = simulation, firmware, body
        self.url = "tcp://{}:{}".format(*simulation.addresses[0])

    @property
    def speed(self) -> float:
        return self.body.speeds[0]

    async def drives(self) -> None:
        await until(lambda: self.speed >= 0.1, SOON)

    async def stands(self) -> None:
        await until(lambda: self.speed == 0, SOON)

    async def run(self, program: str, sent: int | None = None, *others: "Site") -> tuple[int, str]:
        """Run `program` (URL in `url`); send it a signal once it drives here and at `others`.

        Returns its code and what it wrote to stderr.
        """
        async with self.started(program) as child:
            if sent is not None:
                for site in (self, *others):
                    await site.drives()
                child.send_signal(sent)
            async with asyncio.timeout(SOON):
                _, errors = await child.communicate()
        assert child.returncode is not None
        return child.returncode, SLOW.sub("", errors.decode())

    @asynccontextmanager
    async def started(self, program: str) -> AsyncIterator[asyncio.subprocess.Process]:
        """Let `program` run beside the block."""
        code = f"{AS_IN_THE_FOREGROUND}\nurl = {self.url!r}\n" + textwrap.dedent(program)
        child = await asyncio.create_subprocess_exec(
            *(sys.executable, "-X", "dev", "-c", code),
            stdin=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
        )
        try:
            yield child
        finally:
            if child.returncode is None:
                child.kill()
                await child.communicate()


@pytest.fixture
async def site() -> AsyncIterator[Site]:
    async with running() as here:
        yield here


@asynccontextmanager
async def running() -> AsyncIterator[Site]:
    body = Body(load_model("p3at-sh"))
    world = World(None, [body])
    firmware = Recorded(world, body)
    simulation = Simulation(world, [firmware], keep_session=True)  # as a robot on a serial line
    await simulation.listen(0)
    task = asyncio.ensure_future(simulation.run())
    try:
        yield Site(simulation, firmware, body)
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        await asyncio.sleep(0)


async def said_goodbye(site: Site) -> None:
    """Check that the last bytes were the farewell, and that the robot obeyed."""
    await until(lambda: site.firmware.heard.endswith(BYE), SOON)
    await site.stands()
    assert not site.body.drive.powered
    assert not site.firmware.device.is_open


BLOCKING = {
    "return": """
        from pioneer3 import connect
        with connect(url) as robot:
            for _ in range(10):
                robot.drive(0.3)
                list(robot.snapshots(0.1))
        """,
    "forgotten close": """
        from pioneer3 import connect
        robot = connect(url)
        for _ in range(10):
            robot.drive(0.3)
            list(robot.snapshots(0.1))
        """,
    "sys.exit": """
        import sys
        from pioneer3 import connect
        robot = connect(url)
        robot.drive(0.3)
        sys.exit()
        """,
}


@pytest.mark.realtime
@pytest.mark.parametrize("way", BLOCKING)
async def test_a_script_that_ends_leaves_the_robot_stopped(site: Site, way: str) -> None:
    code, errors = await site.run(BLOCKING[way])
    assert (code, errors) == (0, "")
    await said_goodbye(site)


@pytest.mark.realtime
async def test_an_exception_inside_with_stops_the_robot_and_comes_through(site: Site) -> None:
    code, errors = await site.run("""
        from pioneer3 import connect
        with connect(url) as robot:
            robot.drive(0.3)
            raise RuntimeError("the student's own")
        """)
    assert code == 1
    assert errors.strip().endswith("RuntimeError: the student's own")
    await said_goodbye(site)


SCRIPT = """
    from pioneer3 import connect
    with connect(url) as robot:
        while True:
            robot.drive(0.3)
            list(robot.snapshots(0.1))
    """
LONG_MOVE = """
    from pioneer3 import connect
    with connect(url) as robot:
        robot.move(50.0)
    """
NO_WITH = """
    from pioneer3 import connect
    robot = connect(url)
    robot.move(50.0)
    """
ASYNC = """
    import asyncio
    from pioneer3 import connect_async
    async def main():
        async with connect_async(url) as robot:
            await robot.move(50.0)
    asyncio.run(main())
    """


@pytest.mark.realtime
@pytest.mark.parametrize("sent", SIGNALS_AT_LENGTH, ids=lambda sent: sent.name)
@pytest.mark.parametrize(
    "program", [SCRIPT, LONG_MOVE, NO_WITH, ASYNC], ids=["drive", "move", "no with", "async"]
)
async def test_a_signal_stops_the_robot(site: Site, program: str, sent: int) -> None:
    code, errors = await site.run(program, sent)
    await said_goodbye(site)
    if sent == signal.SIGINT:
        assert code == -signal.SIGINT
        assert errors.strip().endswith("KeyboardInterrupt")
        for accident in ("never awaited", "destroyed", "ResourceWarning"):
            assert accident not in errors
    else:
        assert code == (-sent if sent == signal.SIGQUIT else 128 + sent)
        assert errors == ""


@pytest.mark.realtime
@pytest.mark.parametrize("sent", SIGNALS, ids=lambda sent: sent.name)
async def test_the_robot_is_told_before_the_blocks_of_the_program_end(
    site: Site, sent: int
) -> None:
    program = """
        import sys
        from pioneer3 import connect
        with connect(url) as robot:
            try:
                robot.move(50.0)
            finally:
                sys.stdin.readline()
        """
    async with site.started(program) as child:
        await site.drives()
        child.send_signal(sent)
        await site.stands()
        if sent != signal.SIGINT:
            await said_goodbye(site)
        if sent != signal.SIGQUIT:
            assert child.returncode is None
        await child.communicate(b"go on\n")


THREAD = """
    import threading, time
    from pioneer3 import connect
    robot = connect(url)
    def drive():
        while True:
            robot.drive(0.3)
            time.sleep(0.1)
    threading.Thread(target=drive).start()
    """


@pytest.mark.realtime
@pytest.mark.parametrize("sent", SIGNALS_AT_LENGTH, ids=lambda sent: sent.name)
async def test_a_signal_stops_a_robot_that_another_thread_drives(site: Site, sent: int) -> None:
    await site.run(THREAD, sent)
    await said_goodbye(site)


def with_own_handler(sent: int, *, before: bool, action: str = "pass") -> str:
    """Return a program that has a handler of its own, and leaves when that was called."""
    handle = f"signal.signal({sent}, mine)"
    return f"""
    import sys, time
    from pioneer3 import MotionError, connect
    ended = []
    def mine(number, frame):
        ended.append(number)
        print("mine", file=sys.stderr, flush=True)
        {action}
    {handle if before else ""}
    with connect(url) as robot:
        {"" if before else handle}
        while not ended:
            try:
                robot.drive(0.3)
            except MotionError as refused:
                assert "stopped" in str(refused)
            time.sleep(0.1)
    sys.exit(7)
    """


@pytest.mark.realtime
@pytest.mark.parametrize("before", [True, False], ids=["before", "after"])
@pytest.mark.parametrize("sent", SIGNALS_AT_LENGTH, ids=lambda sent: sent.name)
async def test_a_handler_of_the_program_itself_is_called(
    site: Site, sent: int, before: bool
) -> None:
    assert await site.run(with_own_handler(sent, before=before), sent) == (7, "mine\n")
    await said_goodbye(site)


@pytest.mark.realtime
async def test_a_signal_stops_the_robot_before_a_handler_that_was_there_is_called(
    site: Site,
) -> None:
    waits = with_own_handler(signal.SIGTERM, before=True, action="sys.stdin.readline()")
    async with site.started(waits) as child:
        await site.drives()
        child.send_signal(signal.SIGTERM)
        await site.stands()
        assert child.returncode is None
        assert BYE not in site.firmware.heard
        await child.communicate(b"go on\n")
        assert child.returncode == 7
    await said_goodbye(site)


@pytest.mark.realtime
async def test_a_loop_s_own_handler_is_called_and_the_robot_stopped(site: Site) -> None:
    program = """
        import asyncio, signal, sys
        from pioneer3 import MotionError, connect_async
        async def main():
            told = asyncio.Event()
            asyncio.get_running_loop().add_signal_handler(signal.SIGTERM, told.set)
            async with connect_async(url) as robot:
                try:
                    await robot.move(50.0)
                except MotionError as error:
                    print(error, file=sys.stderr)
                await told.wait()
        asyncio.run(main())
        """
    assert await site.run(program, signal.SIGTERM) == (0, "move: somebody stopped the robot\n")
    await said_goodbye(site)


@pytest.mark.realtime
@pytest.mark.parametrize("ignored", [signal.SIGHUP, signal.SIGINT], ids=lambda sent: sent.name)
@pytest.mark.parametrize("program", [SCRIPT, ASYNC], ids=["drive", "async"])
async def test_what_the_program_ignores_stops_nothing(
    site: Site, program: str, ignored: int
) -> None:
    nohup = f"import signal; signal.signal({ignored}, signal.SIG_IGN)\n"
    async with site.started(nohup + textwrap.dedent(program)) as child:
        await site.drives()
        child.send_signal(ignored)
        went_by = site.body.robot_in_world.x
        await until(lambda: site.body.robot_in_world.x > went_by + 0.3, SOON)
        child.send_signal(signal.SIGTERM)
        await child.communicate()
        assert child.returncode == 128 + signal.SIGTERM
    await said_goodbye(site)


@pytest.mark.realtime
async def test_each_robot_that_is_left_open_is_told_in_whatever_order_others_were_left(
    site: Site,
) -> None:
    async with running() as other, running() as third:
        program = f"""
        import time
        from pioneer3 import connect
        first, second, third = connect(url), connect({other.url!r}), connect({third.url!r})
        second.close()
        first.close()
        while True:
            third.drive(0.3)
            time.sleep(0.1)
        """
        code, errors = await third.run(program.replace("(url)", f"({site.url!r})"), signal.SIGHUP)
        assert (code, errors) == (128 + signal.SIGHUP, "")
        for each in (site, other, third):
            await said_goodbye(each)


@pytest.mark.realtime
async def test_when_all_robots_are_left_signals_do_what_they_did(site: Site) -> None:
    program = """
        import signal
        from pioneer3 import connect
        numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
        before = [signal.getsignal(number) for number in numbers]
        first = connect(url)
        first.close()
        assert [signal.getsignal(number) for number in numbers] == before
        """
    assert await site.run(program) == (0, "")


def test_robots_that_come_and_go_beside_each_other_leave_nothing_behind() -> None:
    loop = asyncio.new_event_loop()
    before = signal.getsignal(signal.SIGTERM)
    one = StopOnSignals(loop, lambda: None)
    one.__enter__()
    for _ in range(100):  # the next one is there before the last one goes
        other = StopOnSignals(loop, lambda: None)
        other.__enter__()
        one.__exit__(None, None, None)
        one = other
    assert one._before[signal.SIGTERM] == before
    one.__exit__(None, None, None)
    assert signal.getsignal(signal.SIGTERM) == before
    loop.close()


@pytest.mark.realtime
async def test_interrupting_a_connection_that_does_not_come_about_ends_it(
    unused_tcp_port: int,
) -> None:
    heard = bytearray()
    knocked = asyncio.Event()

    async def mute(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while data := await reader.read(1000):
            heard.extend(data)
            knocked.set()
        writer.close()

    server = await asyncio.start_server(mute, "127.0.0.1", unused_tcp_port)
    async with server:
        url = f"tcp://127.0.0.1:{unused_tcp_port}"
        code = f"{AS_IN_THE_FOREGROUND}\nfrom pioneer3 import connect\nconnect({url!r})"
        child = await asyncio.create_subprocess_exec(
            sys.executable, "-X", "dev", "-c", code, stderr=asyncio.subprocess.PIPE
        )
        async with asyncio.timeout(SOON):
            await knocked.wait()
            child.send_signal(signal.SIGINT)
            _, errors = await child.communicate()
            await until(lambda: heard.endswith(BYE))
    assert errors.decode().strip().endswith("KeyboardInterrupt")
    assert b"destroyed" not in errors
    assert b"ResourceWarning" not in errors


@pytest.mark.realtime
async def test_sigterm_stops_every_robot_of_a_program(site: Site) -> None:
    async with running() as other:
        program = f"""
        import asyncio
        from pioneer3 import connect_async

        async def drive(url):
            async with connect_async(url) as robot:
                while True:
                    robot.drive(0.3)
                    await asyncio.sleep(0.1)

        async def main():
            await asyncio.gather(drive(url), drive({other.url!r}))

        asyncio.run(main())
        """
        code, errors = await site.run(program, signal.SIGTERM, other)
        assert (code, errors) == (128 + signal.SIGTERM, "")
        await said_goodbye(site)
        await said_goodbye(other)


@pytest.mark.realtime
async def test_a_killed_program_leaves_the_robot_to_its_watchdog(site: Site) -> None:
    clock = asyncio.get_running_loop().time
    await site.run(SCRIPT, signal.SIGKILL)
    killed = clock()
    assert site.speed > 0
    async with asyncio.timeout(2.1 + 0.3 / 0.3 + 1.0):  # watchdog, braking, a busy machine
        await site.stands()
    assert clock() - killed > 0.5
    assert BYE not in site.firmware.heard


async def test_leaving_the_block_says_goodbye() -> None:
    async with SimulatedRobot() as robot:
        async with connect_async(robot.open) as driver:
            await hold(driver, 0.3)
        await asyncio.sleep(0)
        assert robot.wires[0].data.endswith(BYE)
        assert robot.wires[0].commands[-4:] == FAREWELL
        await asyncio.sleep(0.5)
        assert robot.speed == 0
        assert not robot.powered


async def test_an_exception_in_the_block_says_goodbye() -> None:
    async with SimulatedRobot() as robot:
        with pytest.raises(ZeroDivisionError):  # noqa: PT012  the block is what is tested
            async with connect_async(robot.open) as driver:
                driver.drive(0.3)
                raise ZeroDivisionError
        await asyncio.sleep(0)
        assert robot.wires[0].data.endswith(BYE)


@pytest.mark.parametrize("times", [1, 2, 3])
async def test_cancelling_a_task_says_goodbye_however_often_it_is_cancelled(times: int) -> None:
    async with SimulatedRobot() as robot:

        async def program() -> None:
            async with connect_async(robot.open) as driver:
                await driver.move(50)

        task = asyncio.ensure_future(program())
        await asyncio.sleep(2)
        for _ in range(times):
            task.cancel()
            await asyncio.sleep(0)
        with pytest.raises(asyncio.CancelledError):
            await task
        await asyncio.sleep(0.1)
        assert robot.wires[0].data.endswith(BYE)


async def test_cancelling_during_the_handshake_says_goodbye() -> None:
    async with SimulatedRobot(to_host=lambda data: ()) as robot:

        async def program() -> None:
            async with connect_async(robot.open):
                pass

        task = asyncio.ensure_future(program())
        await asyncio.sleep(0.2)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        await asyncio.sleep(0.1)
        assert robot.wires[0].data.endswith(BYE)


async def test_two_robots_are_both_told_when_one_of_their_programs_fails() -> None:
    async with SimulatedRobot() as one, SimulatedRobot() as two:
        with pytest.raises(ZeroDivisionError):  # noqa: PT012  the blocks are what is tested
            async with connect_async(one.open) as first, connect_async(two.open) as second:
                first.drive(0.2)
                second.drive(0.2)
                raise ZeroDivisionError
        await asyncio.sleep(0)
        assert one.wires[0].data.endswith(BYE)
        assert two.wires[0].data.endswith(BYE)


@pytest.mark.realtime
async def test_a_far_end_that_takes_nothing_does_not_hold_up_the_way_out() -> None:
    async with running() as site:
        stuck = asyncio.Event()

        async def relay(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            link = accepted("tcp://client", reader, writer)
            host, port = site.simulation.addresses[0]
            to_robot = await asyncio.open_connection(host, port)

            async def back() -> None:
                while data := await to_robot[0].read(1000):
                    await link.write(data)

            backwards = asyncio.ensure_future(back())
            while not stuck.is_set():
                to_robot[1].write(await link.read())
            backwards.cancel()
            await asyncio.gather(backwards, return_exceptions=True)
            to_robot[1].close()
            await ended.wait()
            await link.close()

        ended = asyncio.Event()
        server = await asyncio.start_server(relay, "127.0.0.1", 0)
        port = server.sockets[0].getsockname()[1]
        async with server, asyncio.timeout(SOON):
            async with connect_async(f"tcp://127.0.0.1:{port}") as driver:
                driver.drive(0.1)
                stuck.set()
                await asyncio.sleep(0.6)
            ended.set()
            await asyncio.sleep(0.1)


def heard_commands(data: bytes) -> list[Command]:
    return [commands.from_payload(payload) for payload in PacketReader().feed(data)]


@pytest.mark.realtime
async def test_a_program_that_is_suspended_and_resumed_does_not_drive_on(site: Site) -> None:
    code = f"url = {site.url!r}\n" + textwrap.dedent(LONG_MOVE)
    child = await asyncio.create_subprocess_exec(
        sys.executable, "-c", code, stderr=asyncio.subprocess.PIPE
    )
    try:
        await site.drives()
        os.kill(child.pid, signal.SIGSTOP)
        await site.stands()
        stood_at = site.body.robot_in_world.x
        os.kill(child.pid, signal.SIGCONT)
        async with asyncio.timeout(SOON):
            _, errors = await child.communicate()
    finally:
        if child.returncode is None:
            child.kill()
            await child.wait()
    assert b"MotionError" in errors
    await said_goodbye(site)
    assert site.body.robot_in_world.x == pytest.approx(stood_at, abs=0.05)


@pytest.mark.realtime
async def test_nothing_is_imported_while_a_robot_waits_for_an_answer(site: Site) -> None:
    program = """
        import asyncio, sys
        from pioneer3 import connect_async
        from pioneer3.links import open_link
        async def main():
            async def opened():
                link = await open_link(url)
                loaded.update(sys.modules)
                return link
            loaded = set()
            async with connect_async(opened):
                print(*sorted(set(sys.modules) - loaded), file=sys.stderr)
        asyncio.run(main())
        """
    assert await site.run(program) == (0, "\n")
