"""One robot of a class: the bridge through which the page and a student's program reach it."""

from collections.abc import Callable
from dataclasses import dataclass

from pioneer3.bridge import Bridge
from pioneer3.classroom.runs import FULL, MOST_BYTES, Draft, RunFolder
from pioneer3.errors import CommandError
from pioneer3.geometry import Pose2
from pioneer3.sim.server.running import RunningSimulation, SimulatedRobot
from pioneer3.web import messages


@dataclass(frozen=True, slots=True)
class Start:
    """The place in a simulated world where a robot began."""

    simulation: RunningSimulation
    robot: SimulatedRobot
    pose: Pose2


@dataclass(slots=True)
class RunRecording:
    """A run that is being recorded, or has ended and waits to be handed in.

    Attributes:
        draft: Its file.
        seconds: Its length; `None` while it goes on.
        failure: The reason why it has ended by itself, or empty.
    """

    draft: Draft
    seconds: float | None = None
    failure: str = ""

    def message(self) -> messages.Recording:
        """Return the part of a message."""
        return messages.Recording(self.draft.began, self.seconds, self.failure)


class ClassRobot:
    """A robot of a class.

    Args:
        number: On the page.
        label: Its name while nobody has it.
        bridge: Reaches it.
        url: Where programs connect to it.
        start: Where it began; `None` of a real one.
        clock: Returns the Unix time [s].

    Attributes:
        recording: The run of its student, `None` without one.
    """

    def __init__(
        self,
        number: int,
        label: str,
        bridge: Bridge,
        url: str,
        *,
        start: Start | None,
        clock: Callable[[], float],
    ) -> None:
        self.number = number
        self.label = label
        self.bridge = bridge
        self.url = url
        self.start = start
        self.recording: RunRecording | None = None
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

    def end_recording(self) -> RunRecording:
        """End the recording; return it.

        Raises:
            CommandError: There is none.
        """
        recording = self.recording
        if recording is None:
            raise CommandError("nothing was recorded: press Record first")
        if recording.seconds is None:
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


PAGE = "the page"
"""The name of the page's own driver at a bridge."""
