"""Finds the errors of a robot's odometry in its log, and drives a simulated twin as it was driven.

Where the log has estimates on a map, these are the truth that odometry is compared with, piece by
piece; the three ratios are those that fit best, and what is left over tells how large the noise is.
"""

from collections.abc import Iterator, Sequence
from dataclasses import astuple, dataclass, replace
from heapq import merge
from itertools import pairwise
from math import inf, isfinite, pi, tau
from operator import itemgetter
from typing import Any, Final

import numpy as np
from numpy.random import default_rng

from pioneer3.analysis.open_log import NANOSECONDS, OpenLog
from pioneer3.arrays import Float
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2, arc_to, wrap
from pioneer3.links.tap import ROBOT
from pioneer3.models import OdometryCorrection, RobotModel, load_model
from pioneer3.models.odometry import (
    GREATEST_RATIO,
    LEAST_RATIO,
    TwistMatrix,
    true_of_measured,
)
from pioneer3.navigation.recording import EstimateMade
from pioneer3.robot.pilot import stands
from pioneer3.runtime.recording import MODEL, TruePoseTold
from pioneer3.runtime.twin import Twin
from pioneer3.sim.realism import OdometryErrors, Realism
from pioneer3.state import Scan, Snapshot

PIECE: Final = 1.5
"""A piece of the drive ends after so many metres and radians together."""
JUMP: Final = 0.3
"""A piece that ends farther off was pushed, or its estimate jumped [m, rad]."""
LEAST_PIECES: Final = 6
"""Fewer pieces tell nothing."""
WAY_UNSURE: Final = 0.01
"""Standard deviation of the position that an estimate tells [m]."""
TURN_UNSURE: Final = 0.003
"""Standard deviation of the heading that an estimate tells [rad]."""
RATIO_UNSURE: Final = 0.05
"""Standard deviation of the ratios of robots of which nothing is known."""
ROUNDS: Final = 8
"""Rounds of the fit: two or three suffice."""
LEAST_NOISE: Final = 0.25
"""Least share of the usual noise that a twin has."""
MOST_NOISE: Final = 4.0
"""Greatest share of it."""
RUNS: Final = 100
"""Runs of the twin that its spread is measured by."""
FINE: Final = 0.1
"""Longest step of a drive [s]."""
SHORTEST: Final = 5.0
"""Shortest drive that is compared [s]."""
STEP: Final = 1e-4
"""Step of the ratios that slopes are measured by."""
FEWEST_RANGES: Final = 40
"""Fewer ranges do not tell their noise."""
MOST_DELAY: Final = 0.5
"""Delays are sought up to this one [s]."""
DELAY_STEP: Final = 0.01
"""Steps in which they are tried [s]."""
FARTHEST: Final = 0.05
"""Most that a side of a robot counts that came farther in one report, or less far [m]: it was held,
or its odometry was reset."""
CLEAR: Final = 0.7
"""A delay is clear by which wheels are off by less than this share of the worst one's error."""
NORMAL: Final = 1.4826
"""Standard deviation over the median of the absolute values, of normal noise."""
COMMON: Final = 8.35
"""A squared distance [spreads^2] that 19 of 20 poses of three numbers are within, of 100 runs."""


@dataclass(frozen=True, slots=True)
class Reading:
    """The controller's own pose at a time of the log [s], and the true one where it is known."""

    time: float
    encoder: Pose2
    truth: Pose2 | None
    stands: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedDrive:
    """A drive that a log tells, of a robot of a model that is not corrected."""

    log: OpenLog
    model: RobotModel
    readings: Sequence[Reading]


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivePiece:
    """A piece of a drive: steps of the controller's own odometry, and the motion they truly were.

    Steps are ways [m] and turns [rad], shape (N,).
    """

    ways: Float
    turns: Float
    truth: Pose2


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedTwin:
    """A robot as a log tells it: its type, the errors of its odometry, and how sure they are.

    Attributes:
        covariance: Of the three ratios, shape (3, 3).
        noise: Of the usual random errors, the share that it has.
        pieces: Number of pieces of the drive that this is from.
        sonar_noise: Standard deviation of a range as a share of it; `None` where that is not told.
        laser_noise: The same of the laser [m].
        delay: Time from a command to the report of its effect [s]; `None` where that is not told.
    """

    model: RobotModel
    covariance: Float
    noise: float
    pieces: int
    sonar_noise: float | None = None
    laser_noise: float | None = None
    delay: float | None = None

    @property
    def unsure(self) -> tuple[float, ...]:
        """Standard errors of the ratios, in their order."""
        return tuple(np.sqrt(np.diag(self.covariance)).tolist())

    def realism(self, realism: Realism) -> Realism:
        """Return the errors of a simulated robot with this one's noise."""
        usual = realism.odometry
        names = ("way_noise", "turn_noise", "drift_noise")
        noise = {name: getattr(usual, name) * self.noise for name in names}
        sonar, laser = realism.sonar, realism.laser_noise
        if self.sonar_noise is not None:
            sonar = replace(sonar, noise=self.sonar_noise)
        return replace(
            realism,
            odometry=replace(usual, **noise),
            sonar=sonar,
            laser_noise=laser if self.laser_noise is None else self.laser_noise,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Likeness:
    """Ends of a drive, seen from its start: of the robot, and of its twin's runs, shape (N, 3)."""

    robot: Pose2
    runs: Float

    @property
    def columns(self) -> tuple[tuple[float, ...], ...]:
        """The robot's pose, the mean of the runs, and their standard deviations."""
        mean, spread = self.runs.mean(axis=0), np.sqrt(np.diag(self._covariance))
        return astuple(self.robot), tuple(mean.tolist()), tuple(spread.tolist())

    @property
    def agrees(self) -> bool:
        """Whether the robot ended where 19 of 20 runs of its twin do."""
        off = np.array(astuple(self.robot)) - self.runs.mean(axis=0)
        off[2] = wrap(off[2])
        return float(off @ np.linalg.solve(self._covariance, off)) < COMMON

    @property
    def _covariance(self) -> Float:
        unsure = np.array([WAY_UNSURE, WAY_UNSURE, TURN_UNSURE])
        covariance: Float = np.cov(self.runs.T) + np.diag(2 * unsure**2)
        return covariance


def read_drive(log: OpenLog) -> RecordedDrive:
    """Return the drive of a log: the readings of its longest connection, and the true poses.

    Raises:
        ConfigError: It is damaged, or of a type that is not known.
    """
    known = set(log.topics())
    origin: Pose2 | None = None
    readings: dict[int, list[Reading]] = {}
    texts = log.info().texts.get(f"{log.prefixes[log.robots[0]]}{ROBOT}", {})
    name, names = texts.get("model", ""), dict[int, str]()
    places = "truth" if "estimate" not in known else "estimate"
    told = _by_time(log, [each for each in (MODEL, places, "snapshot") if each in known])
    last: Snapshot | None = None
    for _, message in told:
        match message:
            case EstimateMade():
                origin = message.odom_in_map if message.sure else None
            case TruePoseTold():
                if last is not None:
                    origin = message.robot_in_world @ last.odometry.robot_in_odom.inverse()
            case RobotModel():
                name = message.name
            case Snapshot(odometry=odometry):
                last, names[message.link.sessions] = message, name
                pose = None if origin is None else origin @ odometry.robot_in_odom
                at = log.time_at(message.stamp)
                reading = Reading(at, odometry.robot_in_encoder, pose, stands(message))
                readings.setdefault(message.link.sessions, []).append(reading)
    if not readings:
        raise ConfigError(f"{log.path}: it has no readings of a robot")
    longest = max(readings, key=lambda session: len(readings[session]))
    return RecordedDrive(log=log, model=load_model(names[longest]), readings=readings[longest])


def twin_of(drive: RecordedDrive) -> FittedTwin:
    """Return the twin that fits a drive of a robot best.

    Raises:
        ConfigError: It tells too little, with the reason.
    """
    pieces, width = list(_pieces(drive.readings)), drive.model.wheel_base
    if pieces:
        off = abs(_off(pieces, np.ones(3), width)).max(axis=1)
        pieces = [piece for piece, far in zip(pieces, off, strict=True) if far < JUMP]
    if len(pieces) < LEAST_PIECES:
        raise ConfigError(
            f"{drive.log.path}: it has {len(pieces)} pieces of {PIECE:g} m or radians in which the"
            f" robot was sure of its place on a map, but {LEAST_PIECES} are needed: drive longer"
            " with a map and a laser, or write [odometry] into the robot's own file"
        )
    ratios, covariance, noise = _fitted(pieces, width)
    bounded = np.clip(ratios, LEAST_RATIO, GREATEST_RATIO).tolist()
    measured = replace(drive.model, odometry=OdometryCorrection(*bounded))
    sonar_noise, laser_noise = _range_noise(drive.log)
    return FittedTwin(
        model=measured,
        delay=_delay(drive),
        covariance=covariance,
        noise=noise,
        pieces=len(pieces),
        sonar_noise=sonar_noise,
        laser_noise=laser_noise,
    )


def likeness(drive: RecordedDrive, twin: FittedTwin, seed: int = 0) -> Likeness:
    """Drive the twin by the bytes that the robot was sent, many times, and compare the ends.

    The runs differ by the noise, and by what is not known of the ratios. Nothing is in their way.

    Raises:
        ConfigError: The robot does not stand at a known place twice, or the log is damaged.
    """
    standing = [each for each in drive.readings if each.stands and each.truth is not None]
    if not standing or standing[-1].time - standing[0].time < SHORTEST:
        raise ConfigError(f"{drive.log.path}: the robot does not begin and end at a known place")
    first, last = standing[0], standing[-1]
    assert first.truth is not None
    assert last.truth is not None
    _, travel = _driven(drive, first.time, last.time)
    left, right = np.diff(travel, axis=0).T
    ways, turns = (left + right) / 2, (right - left) / drive.model.wheel_base
    rng = default_rng(seed)
    drawn = rng.multivariate_normal(astuple(twin.model.odometry), twin.covariance, RUNS)
    matrices = [_matrix(ratios, drive.model.wheel_base) for ratios in drawn]
    noise = rng.standard_normal((3, RUNS, len(ways))) * twin.noise
    usual = OdometryErrors()
    slipped = usual.way_noise * np.sqrt(abs(ways)) * noise[0]
    turned = usual.turn_noise * np.sqrt(abs(turns)) * noise[1]
    turned += usual.drift_noise * np.sqrt(abs(ways)) * noise[2]
    v_of_v, v_of_w, w_of_v, w_of_w = np.array(matrices).T[..., None]
    runs = _ends(v_of_v * ways + v_of_w * turns + slipped, w_of_v * ways + w_of_w * turns + turned)
    robot = first.truth.inverse() @ last.truth
    runs[:, 2] = robot.theta + _wrapped(runs[:, 2] - robot.theta)
    return Likeness(robot=robot, runs=runs)


def _driven(drive: RecordedDrive, begin: float, end: float) -> tuple[Float, Float]:
    """Return times (N,) and ways since the begin (N, 2) of wheels that are told what these were.

    Nothing is in the way, and the ramps are the simulator's.
    """
    twin, now = Twin(drive.model, begin), begin
    times, travel = [begin], [twin.body.wheel_travel]

    def wait(until: float) -> None:
        nonlocal now
        while now < until:
            now = min(now + FINE, until)
            twin.go_on(now)
            times.append(now)
            travel.append(twin.body.wheel_travel)

    for at, data in _sent(drive.log):
        if at >= end:
            break
        wait(at)  # not before the begin: what came then sets limits, and switches the motors on
        twin.receive(data, at)
    wait(end)
    return np.array(times), np.array(travel)


def _delay(drive: RecordedDrive) -> float | None:
    """Return the time from a command to the report of its effect [s].

    It is that by which the reported ways of the wheels lag behind those of a twin; `None` where
    no time fits better than others, as of a robot that stood.
    """
    at = np.array([each.time for each in drive.readings])
    times, travel = _driven(drive, at[0], at[-1])
    steps = (
        arc_to(before.encoder.inverse() @ after.encoder)[0]
        for before, after in pairwise(drive.readings)
    )
    half = drive.model.wheel_base / 2
    went = np.array([(step.v - step.w * half, step.v + step.w * half) for step in steps])
    lags = np.arange(0.0, MOST_DELAY, DELAY_STEP)
    off = []
    for lag in lags:
        told = np.stack([np.interp(at - lag, times, side) for side in travel.T], axis=1)
        off.append(float(abs(went - np.diff(told, axis=0)).clip(max=FARTHEST).sum()))
    return float(lags[np.argmin(off)]) if min(off) < CLEAR * max(off) else None


def _range_noise(log: OpenLog) -> tuple[float | None, float | None]:
    """Return the noise of sonar, as a share of the range, and laser [m], of a robot that stands.

    Each range is compared with the one before it.
    """
    heard: dict[int, float] = {}
    seen: Float | None = None
    of_sonar: list[float] = []
    of_laser: list[Float] = []
    is_still = False
    topics = [topic for topic in ("snapshot", "scan/laser") if topic in log.topics()]
    for _, message in _by_time(log, topics):
        if isinstance(message, Scan):
            ranges = np.array(message.ranges)
            if is_still and seen is not None and len(seen) == len(ranges):
                both = np.isfinite(seen) & np.isfinite(ranges)
                of_laser.append(ranges[both] - seen[both])
            seen = ranges if is_still else None
            continue
        is_still = stands(message)
        if not is_still:
            heard, seen = {}, None
        for number in message.sonar.fresh if is_still else ():
            now, before = message.sonar.ranges[number], heard.get(number, inf)
            heard[number] = now
            if isfinite(now) and isfinite(before):
                of_sonar.append(2 * (now - before) / (now + before))
    return _spread(np.array(of_sonar)), _spread(np.concatenate([np.empty(0), *of_laser]))


def _spread(differences: Float) -> float | None:
    """Return the standard deviation of values by their differences; outliers do not count."""
    if len(differences) < FEWEST_RANGES:
        return None
    return float(np.median(abs(differences)) * NORMAL / np.sqrt(2))


def _by_time(log: OpenLog, topics: Sequence[str]) -> Iterator[tuple[float, Any]]:
    """Yield the messages of some topics in the order of their times."""
    return merge(*(log.messages(topic) for topic in topics), key=itemgetter(0))


def _sent(log: OpenLog) -> Iterator[tuple[float, bytes]]:
    """Yield the bytes that the robot was sent, with their times [s]."""
    topic = f"wire/{log.prefixes[log.robots[0]]}{ROBOT}/out"
    began = log.info().began
    for message in log.source.messages(topic.__eq__):
        yield (message.time - began) / NANOSECONDS, message.data


def _pieces(readings: Sequence[Reading]) -> Iterator[DrivePiece]:
    """Yield the pieces of a drive between two known poses, each of :data:`PIECE` or more."""
    begin: Reading | None = None
    steps: list[tuple[float, float]] = []
    for before, reading in pairwise(readings):
        if reading.truth is None or begin is None:
            begin, steps = (None if reading.truth is None else reading), []
            continue
        moved, _ = arc_to(before.encoder.inverse() @ reading.encoder)
        steps.append((moved.v, moved.w))
        if sum(abs(v) + abs(w) for v, w in steps) >= PIECE:
            assert begin.truth is not None
            ways, turns = np.array(steps).T
            yield DrivePiece(ways=ways, turns=turns, truth=begin.truth.inverse() @ reading.truth)
            begin, steps = reading, []


def _ends(ways: Float, turns: Float) -> Float:
    """Return the poses that steps (..., N) end at, shape (..., 3)."""
    headings = np.cumsum(turns, axis=-1) - turns / 2
    chords = ways * np.sinc(turns / tau)
    parts = chords * np.cos(headings), chords * np.sin(headings), turns
    return np.stack([part.sum(axis=-1) for part in parts], axis=-1)


def _matrix(ratios: Float, width: float) -> TwistMatrix:
    scale, base_ratio, wheel_ratio = ratios.tolist()
    return true_of_measured(scale, base_ratio, wheel_ratio, width)


def _wrapped(angles: Float) -> Float:
    wrapped: Float = (angles + pi) % tau - pi
    return wrapped


def _unsure(piece: DrivePiece, usual: OdometryErrors) -> Float:
    """Return the usual variances of the end of a piece, without those of estimates, shape (3,)."""
    way, turn = abs(piece.ways).sum(), abs(piece.turns).sum()
    heading = usual.turn_noise**2 * turn + usual.drift_noise**2 * way
    along, across = usual.way_noise**2 * way, heading * way**2 / 3
    return np.array([along + across / 2, along + across / 2, heading])


def _fitted(pieces: Sequence[DrivePiece], width: float) -> tuple[Float, Float, float]:
    """Return the ratios that fit best, their covariance, and the noise as a share of the usual."""
    usual = np.array([_unsure(piece, OdometryErrors()) for piece in pieces])
    of_estimates = 2 * np.array([WAY_UNSURE, WAY_UNSURE, TURN_UNSURE]) ** 2
    ratios, noise = np.ones(3), 1.0
    covariance = np.eye(3) * RATIO_UNSURE**2
    for _ in range(ROUNDS):
        variance = usual * noise**2 + of_estimates
        off = _off(pieces, ratios, width)
        slopes = np.array(
            [(_off(pieces, ratios + STEP * one, width) - off) / STEP for one in np.eye(3)]
        ).reshape(3, -1)
        weights = 1 / variance.ravel()
        covariance = np.linalg.inv((slopes * weights) @ slopes.T + np.eye(3) / RATIO_UNSURE**2)
        push = (slopes * weights) @ off.ravel() + (ratios - 1) / RATIO_UNSURE**2
        ratios = ratios - covariance @ push
        excess = (_off(pieces, ratios, width) ** 2 - of_estimates).sum(axis=0)
        share = excess[2] / usual[:, 2].sum()
        noise = float(np.sqrt(np.clip(share, LEAST_NOISE**2, MOST_NOISE**2)))
    return ratios, covariance, noise


def _off(pieces: Sequence[DrivePiece], ratios: Float, width: float) -> Float:
    """Return by how much corrected pieces end beside the truth, shape (N, 3)."""
    matrix = _matrix(ratios, width)
    ends = [
        _ends(
            matrix.v_of_v * piece.ways + matrix.v_of_w * piece.turns,
            matrix.w_of_v * piece.ways + matrix.w_of_w * piece.turns,
        )
        for piece in pieces
    ]
    off: Float = np.array(ends) - [astuple(piece.truth) for piece in pieces]
    off[:, 2] = _wrapped(off[:, 2])
    return off
