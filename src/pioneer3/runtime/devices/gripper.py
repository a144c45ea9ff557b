"""The gripper: paddles, lift and beams (arcos.md 5.6, 8.5)."""

import asyncio
from collections.abc import AsyncGenerator
from contextlib import AbstractContextManager

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import GripperAction
from pioneer3.arcos.commands import Request as How
from pioneer3.arcos.reports import Report, Sip
from pioneer3.errors import DeviceError
from pioneer3.robot.requests import Request
from pioneer3.robot.supervisor import Supervisor
from pioneer3.runtime.devices.gripper_state import (
    GENERAL_IO,
    USER_IO,
    Exercise,
    GripperReading,
    read_switches,
    switches_in,
)
from pioneer3.runtime.devices.presence import Presence
from pioneer3.runtime.devices.stream import Stream

WIRINGS = {GENERAL_IO: "general", USER_IO: "user"}


def _asking(how: How) -> Request:
    return Request(
        begin=(commands.GripperPacRequest(how),),
        end=(commands.GripperPacRequest(How.STOP),),
        answers=(reports.GripperState,),
    )


STREAMING = _asking(How.STREAM)


class Gripper:
    """Opens, closes, lifts, and tells how it stands.

    Like ARIA it asks for one GRIPPER packet, which tells the wiring, and reads the switches from
    the standard report; where that ends too early, packets are asked for with every cycle.
    """

    def __init__(self, supervisor: Supervisor) -> None:
        self._supervisor = supervisor
        self._clock = asyncio.get_running_loop().time
        self._stream = Stream(
            supervisor, "the gripper", _asking(How.ONCE), self._read, Sip, reports.GripperState
        )
        self._wiring: int | None = None
        self._exercise: Exercise | None = None

    @property
    def presence(self) -> Presence:
        """Whether there is one: its own answer counts, then CONFIG (arcos.md 5.1, field 14)."""
        if self._wiring is not None:
            if self._wiring in WIRINGS:
                return Presence(True, f"The gripper answers: on the {WIRINGS[self._wiring]} I/O.")
            return Presence(False, "The robot has no gripper: it says so in its GRIPPER packet.")
        config = self._supervisor.info.config if self._supervisor.info else None
        if config is None or config.has_gripper is None:
            return Presence(None, "Nobody knows of a gripper: the robot's CONFIG does not tell.")
        if config.has_gripper:
            return Presence(True, "The robot has a gripper: its CONFIG says HasGripper.")
        return Presence(False, "The robot has no gripper: its CONFIG says HasGripper 0.")

    @property
    def latest(self) -> GripperReading | None:
        """The last reading, while it is :meth:`wanted`."""
        return self._stream.latest

    def wanted(self) -> AbstractContextManager[None]:
        """Keep :attr:`latest` new during the block."""
        return self._stream.wanted()

    def values(self) -> AsyncGenerator[GripperReading, None]:
        """Yield how it stands, with each report."""
        return self._stream.values()

    async def reading(self) -> GripperReading:
        """Return how it stands.

        Raises:
            DeviceError: there is none, or it does not answer.
        """
        self._require()
        return await self._stream.reading()

    def open(self) -> None:
        """Open the paddles. Any action ends an exercise.

        Raises:
            DeviceError: the robot has no gripper; so for all actions.
            CommandError: no robot is connected; so for all actions.
        """
        self._act(GripperAction.OPEN)

    def close(self) -> None:
        """Close the paddles until they touch something."""
        self._act(GripperAction.CLOSE)

    def lift_up(self) -> None:
        """Raise the lift to its upper end."""
        self._act(GripperAction.LIFT_UP)

    def lift_down(self) -> None:
        """Lower the lift to its lower end."""
        self._act(GripperAction.LIFT_DOWN)

    def stop_paddles(self) -> None:
        """Stop the paddles where they are."""
        self._act(GripperAction.STOP)

    def stop_lift(self) -> None:
        """Stop the lift where it is."""
        self._act(GripperAction.LIFT_STOP)

    def halt(self) -> None:
        """Stop paddles and lift."""
        self._act(GripperAction.HALT)

    def store(self) -> None:
        """Close and raise, to drive."""
        self._act(GripperAction.STORE)

    def deploy(self) -> None:
        """Lower and open, to grasp."""
        self._act(GripperAction.DEPLOY)

    def set_grasp_time(self, seconds: float) -> None:
        """Set how long the paddles go on pressing, in steps of 20 ms."""
        self._act(GripperAction.PRESSURE)
        self._supervisor.send(commands.GripperVal(seconds))

    def carry_lift(self, seconds: float) -> None:
        """Raise the lift for so long, in steps of 20 ms."""
        self._act(GripperAction.LIFT_CARRY)
        self._supervisor.send(commands.GripperVal(seconds))

    async def exercise(self) -> None:
        """Open, close, raise and lower until any other action, or until cancelled; then halt.

        Raises:
            DeviceError: there is no gripper.
        """
        self._require()
        mine = self._exercise = Exercise(self._clock())
        for action in Exercise.FIRST:
            self._supervisor.send(commands.Gripper(action))
        try:
            async for reading in self.values():
                if self._exercise is not mine:
                    return
                following = mine.step(reading, self._clock())
                if following is not None:
                    self._supervisor.send(commands.Gripper(following))
        finally:
            if self._exercise is mine:
                self._exercise = None
                if self._supervisor.snapshot is not None:
                    self._supervisor.send(commands.Gripper(GripperAction.HALT))

    @property
    def exercising(self) -> bool:
        """Whether an exercise goes on."""
        return self._exercise is not None

    def _act(self, action: GripperAction) -> None:
        self._require()
        if self._exercise is not None:  # it is halted before anything else is done
            self._exercise = None
            self._supervisor.send(commands.Gripper(GripperAction.HALT))
        self._supervisor.send(commands.Gripper(action))

    def _require(self) -> None:
        if self.presence.there is False:
            raise DeviceError(str(self.presence))

    def _read(self, report: Report, stamp: float) -> GripperReading | None:
        match report:
            case reports.GripperState(wiring, seen):
                self._wiring = wiring
                return read_switches(seen, stamp) if wiring in WIRINGS else None
            case Sip() if self.presence.there:
                seen_in_sip = switches_in(report, self._wiring or GENERAL_IO)
                if seen_in_sip is not None:
                    return read_switches(seen_in_sip, stamp)
                if self._stream.request != STREAMING:
                    self._stream.request = STREAMING
                    self._stream.change(STREAMING)
        return None
