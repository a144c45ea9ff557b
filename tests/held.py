"""A command that an input holds while its robot is stopped, in all the ways there are.

Values in, values out: a real :class:`Pilot` counts the stops, no loop runs.
"""

from collections.abc import Callable

from pioneer3.behaviors.actions import Hold
from pioneer3.errors import Refusal
from pioneer3.geometry import STILL, Twist2
from pioneer3.limits import Limits
from pioneer3.robot.pilot import HELD, LONGEST_PAUSE, Pilot, VelocityCommand
from pioneer3.ros.node.command_order import CommandStream
from pioneer3.state import Bumpers, Motors
from pioneer3.stops import Freshness
from tests.unit.behaviors.support import seen

FORTH, BACK, LEFT = Twist2(0.3, 0.0), Twist2(-0.2, 0.0), Twist2(0.0, 0.5)
LIMITS = Limits(max_speed=0.7, max_turn_rate=1.5)
STEP, LASTS = 0.1, 0.5
ON = Motors(enabled=True)


class Driver:
    """An input that drives a robot, and a mode that began at the same time.

    Args:
        streams: Whether the input sends a stream.

    Attributes:
        now: [s].
    """

    def __init__(self, *, streams: bool = True) -> None:
        self.now = 0.0
        self.hold = Hold("page", streams=streams)
        self.pilot = Pilot()
        self.open()
        self.mode = Freshness.new(self.pilot.last_stop)

    def open(self) -> None:
        """Open a session."""
        self.pilot.session_opened(LIMITS, self.now)
        self.see()

    def see(self, motors: Motors = ON, *, bumper: bool = False) -> None:
        """Show a snapshot to the pilot."""
        bumpers = Bumpers(front=(bumper,))
        self.pilot.observe(seen(self.now, motors=motors, bumpers=bumpers).snapshot, self.now)

    def wait(self, seconds: float) -> None:
        """Send nothing, while the robot reports."""
        for _ in range(round(seconds / STEP)):
            self.now += STEP
            self.see()

    def take(self, twist: Twist2) -> Refusal | None:
        """Set the hold."""
        self.hold.set(twist, self.now, LASTS, self.pilot.last_stop)
        return self.hold.ignored(self.pilot.last_stop)

    def send(self, twist: Twist2, seconds: float = STEP, *, bumper: bool = False) -> str:
        """Hold `twist` for so long; return whether that is `obeyed` or `ignored` in the end."""
        obeyed = False
        for _ in range(round(seconds / STEP)):
            self.now += STEP
            obeyed = self.take(twist) is None and self.is_driven(twist)
            self.see(bumper=bumper)
        return "obeyed" if obeyed else "ignored"

    def is_driven(self, twist: Twist2) -> bool:
        """Ask the pilot for `twist`; return whether it obeys."""
        refused = self.pilot.drive(
            VelocityCommand(twist, after=self.pilot.last_stop.number), self.now
        )
        return refused is None and self.pilot.asked(self.now) == twist

    def let_go(self) -> None:
        """Set the hold to zero, as the end of a stream does."""
        self.take(STILL)


class Publisher(Driver):
    """A publisher of ROS that drives a robot."""

    def __init__(self) -> None:
        super().__init__()
        self.stream = CommandStream("talker", LASTS, resumes=True)

    def take(self, twist: Twist2) -> Refusal | None:
        """Take a command, or wait for the next one."""
        ignored = self.stream.take(twist, self.now, self.pilot.last_stop, contested=False)
        return Refusal("it waits") if self.stream.waits else ignored


def stall(driver: Driver) -> None:
    driver.see(Motors(enabled=True, left_stalled=True))


def bump(driver: Driver) -> None:
    driver.send(FORTH, HELD + 2 * STEP, bumper=True)


def stop(driver: Driver) -> None:
    driver.pilot.stop(driver.now)


def switch(driver: Driver) -> None:
    driver.pilot.set_motors(on=True, now=driver.now)


def emergency_stop(driver: Driver) -> None:
    driver.pilot.emergency_stop(driver.now)
    driver.pilot.reset_emergency_stop()


def button(driver: Driver) -> None:
    driver.see(Motors(stop_button=True))


def link(driver: Driver) -> None:
    driver.pilot.session_lost("pulled out", driver.now)
    driver.open()


def motors_off(driver: Driver) -> None:
    driver.see(Motors())


def raw_command(driver: Driver) -> None:
    driver.pilot.leave_to_raw_commands(driver.now)


def sleep(driver: Driver) -> None:
    driver.pilot.tick(driver.now + LONGEST_PAUSE + STEP)


def silence(driver: Driver) -> None:
    driver.wait(4.0)


def another_input(driver: Driver) -> None:
    driver.hold.overrule("the gamepad drives", driver.now)


CAUSES: dict[str, Callable[[Driver], None]] = {
    "stalled wheels": stall,
    "a bumper held for 2 s": bump,
    "somebody else's stop": stop,
    "the motor switch": switch,
    "emergency stop and reset": emergency_stop,
    "stop button": button,
    "a lost link and its return": link,
    "motors off": motors_off,
    "a raw command": raw_command,
    "a program that slept": sleep,
    "silence of the page that drove": silence,
    "silence of the publisher that drove": silence,
    "an input that comes first": another_input,
}
"""What the first column of the table in :mod:`pioneer3.stops` names."""
