"""The procedure of a robot's calibration: its steps in turn, and the numbers for its own file."""

import asyncio
from collections.abc import Mapping

from pioneer3.calibration.calibration import Calibration
from pioneer3.calibration.course import Measurable, StepDrive, drive
from pioneer3.calibration.own_file import Numbers, file_of
from pioneer3.calibration.steps import By, CalibrationStep, plan, usual_side
from pioneer3.robot.config_backup import encoders_of
from pioneer3.robot.supervisor import RobotInfo, is_simulator


class Procedure:
    """Steps of the calibration of one robot, by a laser or by tape.

    A square has a `side`, the line a `length` [m]; squares are driven so many `rounds`.

    Attributes:
        steps: All of them.
        number: That of the present step, from 0; after the last one, their count.
        told: What was measured.
        info: The robot that is measured.
        path: Of its own file, for the numbers.

    Raises:
        ConfigError: The numbers could not be written there, as :func:`file_of` tells.
    """

    def __init__(
        self,
        info: RobotInfo,
        told: Calibration,
        *,
        by_laser: bool,
        side: float | None = None,
        length: float | None = None,
        rounds: int = 2,
    ) -> None:
        model = info.model
        side = side or usual_side(model)
        self.steps = plan(
            model, side, length or side, rounds, by_laser=by_laser, by_sonar=bool(model.sonars)
        )
        self.number, self.told, self.info = 0, told, info
        self.path = file_of(info)

    @property
    def step(self) -> CalibrationStep | None:
        """The step to be driven and measured, `None` after the last one."""
        return self.steps[self.number] if self.number < len(self.steps) else None

    @property
    def reach(self) -> float:
        """Side of the free floor that all steps take [m]."""
        return max(step.room.x_max - step.room.x_min for step in self.steps)

    async def drive(self, robot: Measurable) -> StepDrive:
        """Drive the present step.

        Raises:
            MotionError: As :func:`pioneer3.calibration.course.drive` tells.
        """
        step = self.step
        assert step is not None
        return await drive(robot, step.legs, step.room, by_laser=step.by is By.LASER)

    async def take(self, driven: StepDrive, answers: Mapping[str, float]) -> None:
        """Measure the present step, and go on to the next one.

        Raises:
            CommandError, DeviceError: As :meth:`Calibration.take` tells.
        """
        step = self.step
        assert step is not None
        await asyncio.to_thread(self.told.take, step, driven, answers)
        self.number += 1

    def skip(self) -> None:
        """Leave the present step out."""
        self.number = min(self.number + 1, len(self.steps))

    def undo(self, step: CalibrationStep | None = None) -> CalibrationStep | None:
        """Forget a step, or the last one that was measured, and go back to it; return which."""
        forgotten = self.told.undo(step)
        if forgotten is not None:
            self.number = self.steps.index(forgotten)
        return forgotten

    def numbers(self) -> Numbers | None:
        """Return the numbers for the own file; `None` while they are no better than chance."""
        told, own, config = self.told.estimate(), self.info.own, self.info.config
        if told is None or not told.is_known or not told.is_certain:
            return None
        late = self.told.delay() if own and own.lasers else None
        gyro = self.told.gyro_scaler()
        return Numbers(
            odometry=told.correction,
            laser=told.laser if own and own.lasers else None,
            delay=late[0] + own.lasers[0].mount.delay if own and late else None,
            gyro_scaler=gyro[0] if gyro else None,
            encoders=self.info.model.encoders or encoders_of(config),
            serial_number=self._serial_number,
        )

    @property
    def _serial_number(self) -> str:
        """Its serial number, if its own file has none yet."""
        known = self.info.own is not None and self.info.own.serial_number
        if known or self.info.config is None or is_simulator(self.info):
            return ""
        return self.info.config.serial_number
