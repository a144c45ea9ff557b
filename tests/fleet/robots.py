"""Simulated robots at serial ports of on-board computers, and the truth about their motion.

They are a process of their own: robots go on when their computers hang.
"""

import asyncio
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import hypot, inf
from pathlib import Path
from typing import Final

from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import RobotSpec
from pioneer3.sim.worldfile.arguments import WorldOverrides
from tests.fleet.lab import ROOT, OnBoard

DEVICE: Final = "/dev/ttyUSB0"
PERIOD: Final = 0.02
"""Between two instants of the truth [s]."""
NICENESS: Final = -15
_DIALOUT: Final = 20
DEVICES: Final = f"""\
set -e
mkdir -p /run/dev
mount -t tmpfs -o mode=755 tmpfs /run/dev
cp -a /dev/null /dev/zero /dev/full /dev/random /dev/urandom /dev/tty /dev/ptmx /run/dev
mkdir /run/dev/pts /run/dev/shm
ln -s /proc/self/fd /run/dev/fd
mount --bind /dev/pts /run/dev/pts
mount -t tmpfs tmpfs /run/dev/shm
touch /run/dev/ttyUSB0
mount --bind "$1" /run/dev/ttyUSB0
mount --rbind /run/dev /dev
[ -c {DEVICE} ]
"""


@dataclass(frozen=True, slots=True)
class Instant:
    """The truth about one robot at one time.

    Attributes:
        time: [s, monotonic].
        speed: [m/s].
        turn_rate: [rad/s].
        travelled: Distance from where it began [m].
    """

    time: float
    speed: float
    turn_rate: float
    travelled: float

    @property
    def stands(self) -> bool:
        return abs(self.speed) < 0.001 and abs(self.turn_rate) < 0.001


@dataclass(frozen=True, slots=True)
class Robots:
    """The robots behind a process of :func:`plugged_in`.

    Attributes:
        path: File of the truth.
        names: Of the robots, in the order of their computers.
    """

    path: Path
    names: Sequence[str]

    def truth(self, name: str, since: float = 0.0) -> list[Instant]:
        """Return all that is known of a robot since a time [s, monotonic]."""
        number = self.names.index(name)
        found = []
        for line in self.path.read_text().splitlines():
            try:
                now, robots = json.loads(line)
            except ValueError:  # the last line is not complete yet
                break
            if now >= since:
                found.append(Instant(now, *robots[number]))
        return found

    def now(self, name: str) -> Instant:
        """Return the latest instant of a robot."""
        with self.path.open("rb") as file:
            file.seek(0, os.SEEK_END)
            file.seek(max(0, file.tell() - 4000))
            line = file.read().split(b"\n")[-2]
        now, robots = json.loads(line)
        return Instant(now, *robots[self.names.index(name)])

    def stood(self, name: str, since: float, until: float = inf) -> float | None:
        """Return how long after a time a robot stood, to stay so until another one.

        `None` if it moves still.
        """
        instants = [each for each in self.truth(name, since) if each.time <= until]
        moving = [each.time for each in instants if not each.stands]
        if not moving:
            return 0.0
        return None if moving[-1] == instants[-1].time else moving[-1] - since


@contextmanager
def preferred() -> Iterator[None]:
    """Let this thread, and all that it starts, come before other work of a busy machine.

    Computers and robots of a lab share no processor with anybody else.
    """
    before = os.getpriority(os.PRIO_PROCESS, 0)
    os.setpriority(os.PRIO_PROCESS, 0, NICENESS)
    try:
        yield
    finally:
        os.setpriority(os.PRIO_PROCESS, 0, before)


@contextmanager
def plugged_in(computers: Sequence[OnBoard], folder: Path) -> Iterator[Robots]:
    """Plug a robot into each computer, as a serial port of the group `dialout`."""
    path = folder / "truth.jsonl"
    words = ["setpriv", "--pdeathsig", "KILL", sys.executable, "-m", "tests.fleet.robots"]
    words += [str(len(computers)), str(path)]
    environment = {**os.environ, "PYTHONPATH": f"{ROOT / 'src'}:{ROOT}"}
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True, env=environment) as process:
        try:
            assert process.stdout is not None
            for computer in computers:
                terminal = process.stdout.readline().strip()
                assert terminal.startswith("/dev/pts/"), terminal
                os.chown(terminal, 0, _DIALOUT)
                Path(terminal).chmod(0o660)
                subprocess.run([*computer.inside, "sh", "-c", DEVICES, "sh", terminal], check=True)
            assert process.stdout.readline() == "ready\n"
            yield Robots(path, [computer.name for computer in computers])
        finally:
            process.terminate()


async def _serve(number: int, path: Path) -> None:
    """Simulate robots, and write the truth about them, until terminated."""
    words = WorldOverrides(robots=tuple(RobotSpec(model="p3at") for _ in range(number)))
    async with simulator(map_name="empty", port=0, ptys=True, overrides=words) as here:
        for robot in here.robots:
            print(robot.pty, flush=True)  # noqa: T201
        with path.open("w", buffering=1) as file:
            print("ready", flush=True)  # noqa: T201
            while True:
                bodies = [robot.body for robot in here.robots]
                rows = [
                    (
                        round(body.speeds[0], 4),
                        round(body.speeds[1], 4),
                        round(
                            hypot(
                                body.robot_in_world.x - body.home.x,
                                body.robot_in_world.y - body.home.y,
                            ),
                            4,
                        ),
                    )
                    for body in bodies
                ]
                file.write(f"{json.dumps((time.monotonic(), rows))}\n")
                await asyncio.sleep(PERIOD)


if __name__ == "__main__":
    asyncio.run(_serve(int(sys.argv[1]), Path(sys.argv[2])))
