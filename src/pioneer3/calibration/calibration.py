"""A calibration that goes on: the steps that were measured, and what they tell together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import cos, degrees, hypot, inf, isnan, nan, pi, radians, sin

import numpy as np

from pioneer3.calibration.course import StepDrive
from pioneer3.calibration.echoes import full_turn
from pioneer3.calibration.ends import MeasuredRun
from pioneer3.calibration.estimate import NAMES, SHOWN_SIDE, CorrectionEstimate, estimate
from pioneer3.calibration.scans import SeenPoses, delay_of, delays, seen_runs
from pioneer3.calibration.steps import By, CalibrationStep
from pioneer3.calibration.umbmark import Umbmark, umbmark
from pioneer3.errors import CommandError
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.maps import LineMap
from pioneer3.models import OdometryCorrection, RobotModel

TAPE_SIGMA = 0.003
"""Standard deviation of a length by a tape [m]."""
ANGLE_SIGMA = radians(1)
"""Standard deviation of an angle by eye, and of how well a robot is set on its mark [rad]."""
MOST_OFF = 0.3
"""Error of an end over the way that is believed at most."""
GYRO_SIGMA = radians(1)
"""Standard deviation of a turn by the gyro, by the drift of its zero [rad]."""
LEAST_TURN = radians(300)
"""Shorter turns tell nothing about the gyro [rad]."""
MOST_TURNED = radians(120)
"""Error of a heading that is believed at most [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredStep:
    """A step that was driven and measured; `begin` is where the laser began, in its frame."""

    step: CalibrationStep
    drive: StepDrive
    runs: Sequence[MeasuredRun]
    begin: Pose2 = ORIGIN


@dataclass(frozen=True, slots=True, kw_only=True)
class StepError:
    """The error of a step: by the correction in force, and by that of all other steps.

    Attributes:
        way: Distance of the true end from odometry's [m]; `turn` likewise, of the heading [rad].
        way_after: The same with the new correction; NaN where no other step tells one.
    """

    name: str
    way: float
    turn: float
    way_after: float
    turn_after: float


class Calibration:
    """Gathers measured steps of one robot, the `laser` of which is said to be there on it.

    With a map, `walls`, the laser is looked for on it, from the pose `begin` on.
    """

    def __init__(
        self,
        model: RobotModel,
        laser: Pose2 = ORIGIN,
        walls: LineMap | None = None,
        begin: Pose2 = ORIGIN,
    ) -> None:
        self.measured: list[MeasuredStep] = []
        self._model, self._laser = model, laser
        self._poses = SeenPoses(walls, begin @ laser)

    @property
    def before(self) -> OdometryCorrection:
        """The correction in force."""
        return self._model.odometry

    def take(
        self, step: CalibrationStep, drive: StepDrive, answers: Mapping[str, float] | None = None
    ) -> None:
        """Add a step; by tape with the `answers` of a person [m, rad], NaN where there is none.

        It takes the place of the same step if that was measured before.

        Raises:
            CommandError: An answer is far from what odometry tells.
            DeviceError: Sonars or laser do not tell the end.
        """
        begin = ORIGIN
        if step.by is By.LASER:
            base = self._model.wheel_base
            begin, runs = seen_runs(drive, self._poses, self.before, base, self._laser)
        elif step.by is By.SONAR:
            runs = [_turned(step, drive)]
        else:
            runs = [self._by_tape(step, drive, answers or {})]
        self.undo(step)
        self.measured.append(MeasuredStep(step, drive, runs, begin))

    def undo(self, step: CalibrationStep | None = None) -> CalibrationStep | None:
        """Forget a step, or the last one; return which."""
        names = [each.step.name for each in self.measured]
        if step is None:
            return self.measured.pop().step if names else None
        if step.name not in names:
            return None
        return self.measured.pop(names.index(step.name)).step

    def estimate(self, without: MeasuredStep | None = None) -> CorrectionEstimate | None:
        """Return the estimate by all steps, or by all `without` one; `None` before any."""
        runs = [run for each in self.measured if each is not without for run in each.runs]
        base = self._model.wheel_base
        return estimate(runs, base, self.before, self._laser) if runs else None

    def changes(self) -> list[StepError]:
        """Return the errors of each step before, and by the correction that the others tell."""
        found = []
        for each in self.measured:
            others = self.estimate(each)
            was = self._off(each, self.before, self._laser)
            now = (nan, nan)
            if others is not None:
                now = self._off(each, others.correction, others.laser or self._laser)
            found.append(
                StepError(
                    name=each.step.name,
                    way=was[0],
                    turn=was[1],
                    way_after=now[0],
                    turn_after=now[1],
                )
            )
        return found

    def umbmark(self) -> Umbmark | None:
        """Return the errors of squares as UMBmark counts them; `None` unless both ways are there.

        They are those by the correction in force.
        """
        ends: dict[bool, list[tuple[float, float]]] = {True: [], False: []}
        side = 0.0
        told = self.estimate()
        for each in self.measured:
            if not each.step.square:
                continue
            side, run = each.step.square, each.runs[-1]
            laser = (told.laser if told else None) or self._laser
            x, y, _ = (-run.off(self.before, self._model.wheel_base, laser)).tolist()
            if run.of_laser:
                turn = laser.theta
                x, y = x * cos(turn) - y * sin(turn), x * sin(turn) + y * cos(turn)
            # a square to the right begins with a turn to the left
            ends[each.step.left].append((x, y) if each.step.left else (y, -x))
        if not all(ends.values()):
            return None
        return umbmark(ends[False], ends[True], side, self._model.wheel_base)

    def delay(self) -> tuple[float, float] | None:
        """Return the delay of the laser's scans and its standard deviation [s], if known."""
        told = self.estimate()
        if told is None or told.laser is None:
            return None
        late = []
        for each in self.measured:
            rows = each.drive.track.poses(told.correction, self._model.wheel_base)
            first = Pose2(*rows[each.drive.marks[0]].tolist())
            to_frame = each.begin @ (first @ told.laser).inverse()
            seen = [to_frame @ Pose2(*row) @ told.laser for row in rows.tolist()]
            places = np.array([(pose.x, pose.y) for pose in seen])
            headings = np.unwrap([pose.theta for pose in seen])
            late.append(delays(each.drive, self._poses, headings, places))
        return delay_of(late)

    def gyro_scaler(self) -> tuple[float, float] | None:
        """Return the factor on the gyro's rates and its standard deviation; `None` without one."""
        factors, weights = [], []
        for each in self.measured:
            turn, by_gyro = each.runs[-1].end[2], each.drive.gyro_turn
            if abs(turn) > LEAST_TURN and abs(by_gyro) > LEAST_TURN:  # both are known then
                factors.append(turn / by_gyro)
                weights.append(turn**2 / (each.runs[-1].sigma[2] ** 2 + GYRO_SIGMA**2))
        if len(factors) < 2:
            return None
        factor = float(np.average(factors, weights=weights))
        spread = float(np.std(factors, ddof=1) / np.sqrt(len(factors)))
        scaler = self._model.gyro_scaler
        return scaler * factor, scaler * max(spread, 1 / np.sqrt(sum(weights)))

    def lines(self) -> list[str]:
        """Return the lines about the calibration for people."""
        told = self.estimate()
        if told is None:
            return ["nothing was measured"]
        lines = []
        for change in self.changes():
            line = f"{change.name}: off by {_error(change.way, change.turn)}"
            if not isnan(change.way_after):
                after = _error(change.way_after, change.turn_after)
                line += f"; by what the other steps tell {after}"
            lines.append(line)
        if (squares := self.umbmark()) is not None:
            lines.append(f"UMBmark before: {squares.words}")
        if not told.is_known:
            return [*lines, "the steps so far do not tell all: measure squares and the line, too"]
        (was, was_spread), (now, now_spread) = (
            told.return_error(each) for each in (self.before, told.correction)
        )
        lines.append(
            f"a square of {SHOWN_SIDE:g} m would end off by {100 * was:.0f} cm "
            f"(+- {100 * was_spread:.0f}) as it is, and by {100 * now:.0f} cm "
            f"(+- {100 * now_spread:.0f}) with the correction"
        )
        for name, sigma in zip(NAMES, told.sigmas, strict=True):
            lines.append(f"{name} = {getattr(told.correction, name):.5f} +- {sigma:.5f}")
        if told.laser is not None:
            x, y, theta = told.laser_sigma
            lines.append(
                f"laser at x = {told.laser.x:.4f} m +- {x:.4f}, y = {told.laser.y:.4f} m +- {y:.4f}"
                f", looks to {degrees(told.laser.theta):.2f} degrees +- {degrees(theta):.2f}"
            )
            if (late := self.delay()) is not None:
                lines.append(f"its scans are {1000 * late[0]:.0f} ms late +- {1000 * late[1]:.0f}")
        if (gyro := self.gyro_scaler()) is not None:
            lines.append(f"gyro_scaler = {gyro[0]:.4f} +- {gyro[1]:.4f}")
        if not told.is_certain:
            lines.append("this is not better than chance: leave it, or measure more steps")
        return lines

    def _off(
        self, each: MeasuredStep, correction: OdometryCorrection, laser: Pose2
    ) -> tuple[float, float]:
        off = each.runs[-1].off(correction, self._model.wheel_base, laser)
        x, y, turn = np.nan_to_num(off).tolist()
        return hypot(x, y), abs(turn)

    def _by_tape(
        self, step: CalibrationStep, drive: StepDrive, answers: Mapping[str, float]
    ) -> MeasuredRun:
        track = drive.track
        if step.square:
            heading = answers.get("turned", nan)
            turn = 2 * pi * (1 if step.left else -1) + heading
            end: Sequence[float] = (answers["ahead"], answers["left"], turn)
        else:
            end = (answers["way"], answers.get("aside", nan), nan)
        run = MeasuredRun(
            track=track,
            end=end,
            sigma=(TAPE_SIGMA, TAPE_SIGMA, ANGLE_SIGMA),
            begin_sigma=ANGLE_SIGMA,
            name=step.name,
        )
        far = np.abs(np.nan_to_num(run.off(self.before, self._model.wheel_base)))
        if far[:2].max() > MOST_OFF * track.way or far[2] > MOST_TURNED:
            raise CommandError(
                f"{step.name}: {100 * far[:2].max():.0f} cm and {degrees(far[2]):.0f} degrees from "
                "what the wheels tell is more than tyres and loads explain; measure once more"
            )
        return run


def _turned(step: CalibrationStep, drive: StepDrive) -> MeasuredRun:
    """Return the run of full turns by echoes."""
    found = full_turn(drive.echoes)
    counted = float(drive.track.steps[:, 1].sum())
    turn = counted * 2 * pi / found.counted
    return MeasuredRun(
        track=drive.track,
        end=(nan, nan, turn),
        sigma=(inf, inf, abs(turn) * found.sigma / found.counted),
        name=step.name,
    )


def _error(way: float, turn: float) -> str:
    return f"{100 * way:.1f} cm and {degrees(turn):.1f} degrees"
