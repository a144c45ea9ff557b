"""A serial port of the robot's controller: out with TTY, back with GETAUX (protocol.md 5.5)."""

import asyncio
from collections.abc import Callable
from typing import Final

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.reports import SerialAux
from pioneer3.errors import ConfigError, DeviceError
from pioneer3.robot.devices.sensor import silence
from pioneer3.robot.supervisor import Supervisor

PATIENCE = 1.5
"""Longest wait for one answer [s]: it takes up to 20 ms at 9600 baud, and a report's cycle."""
TRIES = 3

Send = Callable[[bytes], Command]
Get = Callable[[int], Command]
PORTS: Final[dict[int, tuple[Send, Get]]] = {
    1: (commands.Tty2, commands.GetAux),
    2: (commands.Tty3, commands.GetAux2),
    3: (commands.Tty4, commands.GetAux3),
}


class AuxPort:
    """One of the ports AUX1 to AUX3.

    Raises:
        ConfigError: there is no such port.
    """

    def __init__(self, supervisor: Supervisor, number: int) -> None:
        if number not in PORTS:
            raise ConfigError(f"AUX{number}: a robot has AUX1, AUX2 and AUX3")
        self.number = number
        self._supervisor = supervisor
        self._send, self._get = PORTS[number]
        self._turn = asyncio.Lock()

    def write(self, data: bytes) -> None:
        """Send `data`, at most 199 bytes, out of the port; CommandError without a robot."""
        self._supervisor.send(self._send(data))

    async def ask(
        self, question: bytes, find: Callable[[bytes], bytes | None], size: int, *, name: str
    ) -> bytes:
        """Send `question` and return the answer, of `size` bytes, that `find` finds.

        The question is sent again if no answer comes. `find` gets all bytes so far; `name` is that
        of the device, for messages.

        Raises:
            DeviceError: no answer came.
            CommandError: no robot is connected.
        """
        async with self._turn:
            for _ in range(TRIES):
                try:
                    async with asyncio.timeout(PATIENCE):
                        return await self._ask_once(question, find, size)
                except TimeoutError:
                    continue
        raise DeviceError(
            silence(self._supervisor, f"{name} on AUX{self.number}", TRIES * PATIENCE)
        )

    async def _ask_once(
        self, question: bytes, find: Callable[[bytes], bytes | None], size: int
    ) -> bytes:
        got = b""
        with self._supervisor.reports.subscribe(SerialAux) as heard:
            self._supervisor.send(self._get(0))  # discard the bytes of earlier questions
            self.write(question)
            self._supervisor.send(self._get(size))
            async for report in heard:
                if report.port != self.number:
                    continue
                got += report.data
                answer = find(got)
                if answer is not None:
                    return answer
                self._supervisor.send(self._get(1))  # other bytes took part of the size
        raise TimeoutError
