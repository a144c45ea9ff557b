"""The services of a ROS 1 node. Each runs in a thread of rospy's and asks the loop."""

import asyncio
from collections.abc import Callable, Sequence
from concurrent.futures import TimeoutError as NoAnswerError
from typing import Any, Final, NamedTuple

from pioneer3.arcos import commands
from pioneer3.errors import CommandError
from pioneer3.geometry import ORIGIN
from pioneer3.ros.interface.topics import Profile, command_names
from pioneer3.ros.messages.diagnostics import Condition, Level
from pioneer3.runtime.robot import Robot

PATIENCE: Final = 2.0
"""Longest wait for the loop [s]."""


class Answer(NamedTuple):
    """Whether it was done, and a sentence for a person."""

    success: bool
    message: str


class Services:
    """What can be asked of the robot beside driving.

    Args:
        robot: Connected.
        profile: Which services there are.
        sonar: Whether the sonars are to ping at first.
        diagnose: Returns how it stands with the robot.
        moved: Called when odometry has been set.
        warn: Given a sentence when something is refused that has no answer.
    """

    def __init__(
        self,
        robot: Robot,
        profile: Profile,
        *,
        sonar: bool,
        diagnose: Callable[[], Sequence[Condition]],
        moved: Callable[[], None],
        warn: Callable[[str], None],
    ) -> None:
        self._robot = robot
        self._profile = profile
        self._sonar = sonar
        self._diagnose = diagnose
        self._moved = moved
        self._warn = warn
        self._auto_enable = robot.supervisor.pilot.auto_enable
        self._loop = asyncio.get_running_loop()

    def advertise(self) -> None:
        """Tell the master, in a thread."""
        import rospy  # noqa: PLC0415
        from std_srvs.srv import (  # noqa: PLC0415
            Empty,
            EmptyResponse,
            SetBool,
            SetBoolResponse,
            Trigger,
            TriggerResponse,
        )

        def offer(name: str, kind: Any, act: Callable[[Any], Any]) -> None:
            for each in command_names(self._profile, name):
                rospy.Service(each, kind, act)

        def switched(on: bool) -> Any:
            answer = self._ask(lambda: self.switch_motors(on=on))
            if not answer.success:
                self._warn(f"the motors stay off: {answer.message}")
            return EmptyResponse()

        offer("enable_motors", Empty, lambda _: switched(True))
        offer("disable_motors", Empty, lambda _: switched(False))
        if self._profile is Profile.COMPATIBILITY:
            return

        def trigger(act: Callable[[], Answer]) -> Callable[[Any], Any]:
            return lambda _: TriggerResponse(*self._ask(act))

        for name, act in (
            ("e_stop_trigger", self.stop_hard),
            ("e_stop_reset", self.release_stop),
            ("reset_odometry", self.reset_odometry),
            ("self_test", self.test),
        ):
            rospy.Service(name, Trigger, trigger(act))
        rospy.Service(
            "sonar/enable",
            SetBool,
            lambda asked: SetBoolResponse(*self._ask(lambda: self.switch_sonar(on=asked.data))),
        )

    def connected(self) -> None:
        """Tell the robot what it does not know yet: every session begins with the sonars on."""
        if not self._sonar:
            self.switch_sonar(on=False)

    def switch_motors(self, *, on: bool) -> Answer:
        """Stop, then switch; motors that were switched off stay so until somebody asks again."""
        refused = self._robot.arbiter.set_motors(on=on)
        if refused is None:
            self._robot.supervisor.pilot.auto_enable = on and self._auto_enable
        return Answer(refused is None, refused or f"the motors go {'on' if on else 'off'}")

    def switch_sonar(self, *, on: bool) -> Answer:
        """Let the sonars ping, or not."""
        self._sonar = on
        try:
            self._robot.send(commands.Sonar(on=on))
        except CommandError as error:
            return Answer(False, str(error))
        return Answer(True, f"the sonars go {'on' if on else 'off'}")

    def stop_hard(self) -> Answer:
        """Stop as hard as possible, motors off, latched."""
        self._robot.emergency_stop()
        return Answer(True, "stopped; e_stop_reset releases it")

    def release_stop(self) -> Answer:
        """Release the latch; the motors stay off."""
        self._robot.reset_emergency_stop()
        snapshot = self._robot.snapshot
        if snapshot is not None and snapshot.motors.stop_button:
            return Answer(False, "the stop button on the robot is pressed: pull it out")
        return Answer(True, "released; the motors stay off until the next command")

    def reset_odometry(self) -> Answer:
        """Stop, and call the present place 0, 0, 0; the robot itself is told nothing."""
        self._robot.stop()
        self._robot.supervisor.assembler.odometer.restart(ORIGIN)
        self._moved()
        return Answer(True, "this place is 0, 0, 0 now")

    def test(self) -> Answer:
        """Say what is wrong, if anything is."""
        wrong = [each for each in self._diagnose() if each.level is not Level.OK]
        broken = any(each.level is not Level.WARN for each in wrong)
        return Answer(not broken, "; ".join(str(each) for each in wrong) or "all is well")

    def _ask(self, act: Callable[[], Answer]) -> Answer:
        """Let the loop act; return what came of it. In a thread of rospy's."""

        async def acting() -> Answer:
            return act()

        try:
            return asyncio.run_coroutine_threadsafe(acting(), self._loop).result(PATIENCE)
        except (RuntimeError, NoAnswerError, asyncio.CancelledError):
            return Answer(False, "the node is ending")
