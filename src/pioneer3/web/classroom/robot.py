"""One robot of a class: the bridge to it, its recording, and its snapshots for the teacher."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from pioneer3.bridge import Bridge
from pioneer3.classroom.runs import FULL, MOST_BYTES, Draft, RunFolder
from pioneer3.errors import CommandError
from pioneer3.geometry import Pose2
from pioneer3.navigation.recording import use_map
from pioneer3.runtime.recording import RobotLog
from pioneer3.sim.server.running import RunningSimulation, SimulatedRobot
from pioneer3.state import Snapshot
from pioneer3.web import messages
from pioneer3.web.control import Operator
from pioneer3.web.robot_view import RobotView

PAGE = "the page"
"""Name of the page's own driver at a bridge."""


@dataclass(frozen=True, slots=True)
class StartPlace:
    """The place in a simulated world where a robot began."""

    simulation: RunningSimulation
    robot: SimulatedRobot
    pose: Pose2


@dataclass(slots=True)
class RunRecording:
    """A run that is being recorded, or has ended and waits to be handed in.

    Its length [s] is `None` while it goes on, and the failure the reason why it ended by itself.
    """

    draft: Draft
    seconds: float | None = None
    failure: str = ""

    def message(self) -> messages.Recording:
        """Return the part of a message."""
        return messages.Recording(self.draft.began, self.seconds, self.failure)


class ClassRobot:
    """A robot of a class, with a label while nobody has it; programs connect to its `url`.

    A real one has no `start`. The clock returns the Unix time [s].
    """

    def __init__(
        self,
        number: int,
        label: str,
        bridge: Bridge,
        url: str,
        *,
        start: StartPlace | None,
        clock: Callable[[], float],
    ) -> None:
        self.number = number
        self.label = label
        self.bridge = bridge
        self.url = url
        self.start = start
        self.recording: RunRecording | None = None
        self._run: RobotLog | None = None
        self._told: Snapshot | None = None
        self._clock = clock

    @property
    def program(self) -> str | None:
        """The address of the program that has the robot, `None` without one."""
        holder = self.bridge.holder
        return None if holder is None or holder == PAGE else holder

    def begin_recording(self, runs: RunFolder) -> None:
        """Record from now on, whoever drives; a run that was not handed in is dropped.

        Raises:
            CommandError: A recording goes on.
            ConfigError: The folder cannot be written to.
        """
        if self.recording is not None and self.recording.seconds is None:
            raise CommandError("a recording goes on already: end it first")
        self.discard_recording()
        draft = runs.draft(self.number, self._clock())
        self.bridge.start_recording(draft.path)
        self.recording = RunRecording(draft)
        self._run = RobotLog(self.bridge.log) if self.bridge.log else None
        self._told = None

    def tell_recording(self, view: RobotView) -> None:
        """Put the newest readings, the map and the true pose into the recording, for a replay."""
        newest = view.robot.supervisor.snapshot
        if self._run is None or newest is None or newest is self._told:
            return
        if self._told is None:
            self._run.describe(view.robot.info)
        self._told = newest
        if (line_map := view.scene.map_now) is not None:
            use_map(self._run, line_map)
        if (robot_in_world := view.scene.true_pose) is not None:
            self._run.truth(robot_in_world)
        self._run.snapshot(newest, view.robot.info.model)

    def end_recording(self) -> RunRecording:
        """End the recording; return it.

        Raises:
            CommandError: There is none.
        """
        recording = self.recording
        if recording is None:
            raise CommandError("nothing was recorded: press Record first")
        if recording.seconds is None:
            self._run = None
            self.bridge.stop_recording()
            recording.seconds = max(0.0, self._clock() - recording.draft.began)
        return recording

    def check_recording(self) -> str:
        """End a recording that cannot go on; return the reason, empty if it can."""
        recording = self.recording
        if recording is None or recording.seconds is not None:
            return ""
        recording.failure = self.bridge.recording_failure
        if recording.draft.size >= MOST_BYTES:
            recording.failure = FULL
        if recording.failure:
            self.end_recording()
        return recording.failure

    def discard_recording(self) -> None:
        """Drop the recording, if there is one."""
        if self.recording is not None:
            self.end_recording().draft.discard()
            self.recording = None


def small_snapshot(
    view: RobotView, program: str | None, is_student: Callable[[Operator], bool]
) -> messages.SmallSnapshot:
    """Return the message part for a robot; `program` is the address of the one that has it."""
    robot = view.robot
    now, latest = robot.supervisor.snapshot, robot.supervisor.snapshots.latest
    pose = view.scene.robot_in_map(latest.odometry.robot_in_odom) if latest else Pose2()
    why = robot.why_not_moving()
    by, driver = _driver(view, program, is_student)
    return messages.SmallSnapshot(
        robot=view.number,
        robot_in_map=(round(pose.x, 2), round(pose.y, 2), round(pose.theta, 2)),
        v=round(now.odometry.twist.v, 2) if now else 0.0,
        battery=round(latest.battery.voltage, 1) if latest else 0.0,
        stalled=now is not None and now.motors.stalled,
        emergency_stop=robot.supervisor.pilot.emergency,
        connected=now is not None,
        by=by,
        driver=driver,
        why=why and why.text,
    )


def _driver(
    view: RobotView, program: str | None, is_student: Callable[[Operator], bool]
) -> tuple[Literal["student", "teacher", "program", "mode"] | None, str | None]:
    """Return the kind of driver, and its name."""
    if program is not None:
        return "program", program
    driver = view.control.who_drives()
    if driver is None or isinstance(driver, str):
        return ("mode", driver) if driver else (None, None)
    return ("student" if is_student(driver) else "teacher"), driver.name
