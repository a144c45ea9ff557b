"""Calibrates a robot of the page: the steps of `pioneer3 calibrate`, one at each request."""

import asyncio
import logging
from collections.abc import Callable
from math import nan

from pioneer3.behaviors.action import Stack
from pioneer3.calibration.calibration import Calibration
from pioneer3.calibration.course import StepDrive
from pioneer3.calibration.own_file import write_numbers
from pioneer3.calibration.procedure import Procedure
from pioneer3.calibration.steps import ANGLES, OPTIONAL, QUESTIONS
from pioneer3.errors import CommandError, MotionError, PioneerError, Refusal
from pioneer3.navigation.connect import prepare_navigation
from pioneer3.robot.devices import Devices
from pioneer3.robot.devices.laser import LaserSource
from pioneer3.runtime.arbiter import Drivable
from pioneer3.runtime.driven import Driven
from pioneer3.runtime.motions import await_mode
from pioneer3.runtime.robot import Robot
from pioneer3.web import messages, requests
from pioneer3.web.control import Control, Operator

log = logging.getLogger(__name__)

LONGEST_LEG = 120.0
"""Time limit of a leg [s]."""


class _ControlledRobot(Driven):
    """A robot whose modes an operator of the page starts: they end when that page falls silent."""

    def __init__(self, robot: Robot, control: Control, operator: Operator) -> None:
        self.arbiter = robot.arbiter
        self._robot, self._control, self._operator = robot, control, operator

    @property
    def supervisor(self) -> Drivable:
        return self._robot.supervisor

    @property
    def devices(self) -> Devices:
        return self._robot.devices

    @property
    def laser(self) -> LaserSource:
        return self._robot.laser

    async def run(self, mode: Stack, seconds: float = LONGEST_LEG) -> None:
        if refused := self._control.start(self._operator, mode, seconds):
            raise MotionError(refused.text)
        try:
            await await_mode(mode, self.arbiter, self.snapshots())
        finally:
            if self.arbiter.mode is mode:
                self.arbiter.end_mode("the calibration ended")


class RobotCalibration:
    """Calibrates one robot of the page.

    `publish` is called with the state, and with `None` when the robot leaves the page.
    """

    def __init__(
        self,
        number: int,
        robot: Robot,
        control: Control,
        *,
        publish: Callable[[messages.CalibrationState | None], None],
    ) -> None:
        self._number, self._robot, self._control = number, robot, control
        self._publish = publish
        self._procedure: Procedure | None = None
        self._driven: StepDrive | None = None
        self._lines: list[str] = []
        self._note = self._waits = ""
        self._asked: asyncio.Queue[tuple[Operator, requests.Calibrate]] = asyncio.Queue()

    def ask(self, operator: Operator, request: requests.Calibrate) -> Refusal | None:
        """Take a request, to be carried out soon."""
        if self._waits:
            return Refusal(f"the calibration {self._waits}: wait, or stop the robot")
        if (self._procedure is None) != (request.step == "begin"):
            begun = self._procedure is not None
            return Refusal("a calibration goes on: end it first" if begun else "begin one first")
        if self._robot.snapshot is None:
            return Refusal("the robot is not connected")
        if refused := self._control.take(operator):
            return refused
        self._waits = "drives a step" if request.step == "drive" else "reckons"
        self._asked.put_nowait((operator, request))
        return None

    async def run(self) -> None:
        """Carry requests out, one after the other, until cancelled."""
        try:
            while True:
                self._publish(self._message())
                operator, request = await self._asked.get()
                self._note = ""
                self._publish(self._message())
                try:
                    await self._carry_out(operator, request)
                except PioneerError as error:
                    self._note = str(error)
                except Exception:
                    log.exception("a step of a calibration failed")
                    self._note = "this step failed; the log has the details"
                self._waits = ""
        finally:
            self._publish(None)

    async def _carry_out(self, operator: Operator, request: requests.Calibrate) -> None:
        procedure = self._procedure
        if procedure is None:
            self._lines, self._driven = [], None
            self._procedure = await self._begun(by_tape=request.by_tape)
            return
        step, driven = procedure.step, self._driven
        match request.step:
            case "drive" if step is not None:
                self._driven = None
                robot = _ControlledRobot(self._robot, self._control, operator)
                self._driven = await procedure.drive(robot)
                if not step.asks:
                    await self._measure(procedure, self._driven, {})
            case "measure" if driven is not None:
                await self._measure(procedure, driven, request.answers)
            case "skip":
                self._driven = None
                procedure.skip()
            case "undo":
                self._driven = None
                procedure.undo()
                await self._tell(procedure)
            case "write":
                await self._write(procedure)
            case "end":
                self._procedure = self._driven = None

    async def _begun(self, *, by_tape: bool) -> Procedure:
        """Return the procedure, by the robot's laser if it has one.

        Raises:
            PioneerError: The laser is silent, or what it needs is not installed.
        """
        info = self._robot.info
        if by_tape or not self._robot.laser.presence.there:
            return Procedure(info, Calibration(info.model), by_laser=False)
        await prepare_navigation()
        laser = (await self._robot.laser.reading()).sensor_in_robot
        return Procedure(info, Calibration(info.model, laser), by_laser=True)

    async def _measure(
        self, procedure: Procedure, driven: StepDrive, answers: dict[str, float]
    ) -> None:
        step = procedure.step
        assert step is not None
        if missing := [name for name in step.asks if name not in answers and name not in OPTIONAL]:
            raise CommandError(f"a number is missing: {QUESTIONS[missing[0]]}")
        await procedure.take(driven, {name: answers.get(name, nan) for name in step.asks})
        self._driven = None
        await self._tell(procedure)

    async def _tell(self, procedure: Procedure) -> None:
        self._lines = await asyncio.to_thread(procedure.told.lines)

    async def _write(self, procedure: Procedure) -> None:
        """Write the own file.

        Raises:
            CommandError: The numbers are no better than chance.
            ConfigError: It cannot be written.
        """
        numbers = await asyncio.to_thread(procedure.numbers)
        if numbers is None:
            raise CommandError("nothing is written: the numbers are not better than chance yet")
        path, before = await asyncio.to_thread(write_numbers, procedure.info, numbers)
        kept = f"; the file as it was before is {before.name}" if before else ""
        self._note = f"wrote {path.name}, which counts from the next connection on{kept}"
        self._procedure = self._driven = None

    def _message(self) -> messages.CalibrationState:
        procedure = self._procedure
        step = procedure.step if procedure else None
        asks = step.asks if step and self._driven is not None and not self._waits else ()
        return messages.CalibrationState(
            self._number,
            going=procedure is not None,
            number=procedure.number + 1 if procedure else 0,
            steps=len(procedure.steps) if procedure else 0,
            title=step.title if step else "",
            needs=step.needs if step else "",
            asks=tuple(
                messages.CalibrationQuestion(
                    name, QUESTIONS[name], angle=name in ANGLES, optional=name in OPTIONAL
                )
                for name in asks
            ),
            waits=self._waits,
            note=self._note,
            lines=tuple(self._lines),
        )
