"""What a simulated robot's controller costs per cycle, the casting of its rays left out."""

from collections.abc import Iterator
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from benchmarks.table import Row
from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command, SimLaserMode
from pioneer3.arcos.packet import encode
from pioneer3.geometry import Pose2
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import CYCLE, Firmware
from pioneer3.sim.world import World

MODEL = load_model("p3at-sh")
CYCLES, ROUNDS = 500, 15
BAR_US = 60.0
"""So 200 robots with lasers take a quarter of a core."""


class Still(World):
    """A world whose sensors have measured already."""

    def __init__(self, body: Body) -> None:
        super().__init__(None, [body])
        random = np.random.default_rng(1)
        self._heard_already = random.uniform(0.1, 5.0, len(body.model.sonars))
        self._numbers = np.arange(len(body.model.sonars))
        self._ranges = random.uniform(0.1, 33.0, 181)

    def fresh_sonar(self, body: Body) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the transducers and what they have measured [m], both (M,)."""
        return self._numbers, self._heard_already

    def laser(
        self, body: Body, mount: Pose2, start: float, step: float, count: int
    ) -> NDArray[np.float64]:
        """Return what the beams have measured [m], shape (count,)."""
        return self._ranges[:count]


def connected(*said: Command) -> Firmware:
    """Return a moving robot in a session, to which `said` was said."""
    body = Body(MODEL)
    firmware = Firmware(Still(body), body, watchdog=0.0)
    handshake = [encode(bytes([number])) for number in (0, 1, 2)]
    begin: tuple[Command, ...] = (commands.Open(), commands.Enable(on=True), *said)
    for frame in (*handshake, *(encode(commands.to_payload(command)) for command in begin)):
        firmware.receive(frame, 0.0)
    body.reset_odometry(Pose2(1.0, -2.0, 0.5))
    body.drive.linear.velocity, body.drive.angular.velocity = 0.3, 0.2
    return firmware


def microseconds(firmware: Firmware) -> float:
    """Return what one cycle takes at best, from the tick to the bytes for the link [us]."""
    best, now = float("inf"), 0.0
    for _ in range(ROUNDS):
        began = perf_counter()
        for _ in range(CYCLES):
            now += CYCLE
            firmware.tick(now)
            firmware.device.outgoing()
        best = min(best, perf_counter() - began)
    return best / CYCLES * 1e6


def microseconds_heard(firmware: Firmware, command: Command) -> float:
    """Return what taking one command costs [us]."""
    frame, best = encode(commands.to_payload(command)), float("inf")
    for _ in range(ROUNDS):
        began = perf_counter()
        for _ in range(CYCLES):
            firmware.receive(frame, 0.0)
        best = min(best, perf_counter() - began)
    return best / CYCLES * 1e6


def rows() -> Iterator[Row]:
    """Measure everything of this file."""
    plain = microseconds(connected())
    yield Row("firmware: standard report with 16 sonars", plain, "us", BAR_US)
    for what, mode in (("0x60", SimLaserMode.RANGES), ("0x61", SimLaserMode.EXTENDED)):
        with_laser = microseconds(connected(commands.SimLrfEnable(mode)))
        yield Row(f"firmware: sweep of 181 beams, {what}", with_laser - plain, "us", BAR_US)
    heard = microseconds_heard(connected(), commands.Vel(0.3))
    yield Row("firmware: one VEL taken", heard, "us", BAR_US)
