"""A gamepad: its buttons, its speeds, and the twist that it asks for. Pure.

Buttons and axes have the numbers of the W3C's "standard gamepad", which browsers use as well; the
speeds and the dead zone are Clearpath's (facts.md 14.3).
"""

from dataclasses import dataclass, field, replace

from pioneer3.geometry import STILL, Twist2


@dataclass(frozen=True, slots=True, kw_only=True)
class Scheme:
    """The buttons, and the speeds.

    Attributes:
        deadman: Must be held to drive: L1, LB.
        turbo: As well, to drive faster: R1, RB.
        stop: The right one of four: B, circle.
        emergency_stop: The small one left of the middle: Back, Share, Select.
        reset: The small one right of it: Start, Options. Ends the emergency stop.
        forward_axis: Of the left stick; counts down.
        turn_axis: Of the left stick; counts to the right.
        dead_zone: Half width of the middle of an axis, 0 to 1.
        speed: At full stick [m/s].
        turn_rate: At full stick [rad/s].
        turbo_speed: The same with turbo [m/s].
        turbo_turn_rate: The same with turbo [rad/s].
    """

    deadman: int = 4
    turbo: int = 5
    stop: int = 1
    emergency_stop: int = 8
    reset: int = 9
    forward_axis: int = 1
    turn_axis: int = 0
    dead_zone: float = 0.1
    speed: float = 0.4
    turn_rate: float = 0.6
    turbo_speed: float = 1.0
    turbo_turn_rate: float = 1.2

    def at(self, speed: float | None, turn_rate: float | None) -> "Scheme":
        """Return the same with other speeds [m/s, rad/s]; turbo keeps its ratio to them."""
        faster = 1.0 if speed is None else speed / self.speed
        quicker = 1.0 if turn_rate is None else turn_rate / self.turn_rate
        return replace(
            self,
            speed=self.speed * faster,
            turbo_speed=self.turbo_speed * faster,
            turn_rate=self.turn_rate * quicker,
            turbo_turn_rate=self.turbo_turn_rate * quicker,
        )


SCHEME = Scheme()


@dataclass(slots=True)
class Gamepad:
    """The state of buttons and sticks, and the twist that they ask for.

    Nothing counts before the deadman button was pressed afresh: not when the gamepad is found with
    the button held, and not after :meth:`let_go`.
    """

    scheme: Scheme = SCHEME
    held: bool = field(default=False, init=False)
    """Whether the deadman button is held, and counts."""
    _pressed: set[int] = field(default_factory=set, init=False)
    _axes: dict[int, float] = field(default_factory=dict, init=False)

    def button(self, number: int, *, pressed: bool) -> None:
        """Take a button that was pressed or let go."""
        fresh = pressed and number not in self._pressed
        (self._pressed.add if pressed else self._pressed.discard)(number)
        if number == self.scheme.deadman:
            self.held = fresh or (pressed and self.held)

    def axis(self, number: int, value: float) -> None:
        """Take the place of an axis, -1 to 1."""
        self._axes[number] = value

    def let_go(self) -> None:
        """Count nothing until the deadman button is pressed afresh."""
        self.held = False

    @property
    def wanted(self) -> Twist2:
        """The twist that the stick asks for; zero while the deadman button is not held."""
        scheme = self.scheme
        if not self.held:
            return STILL
        turbo = scheme.turbo in self._pressed
        return Twist2(
            (scheme.turbo_speed if turbo else scheme.speed) * self._out(scheme.forward_axis),
            (scheme.turbo_turn_rate if turbo else scheme.turn_rate) * self._out(scheme.turn_axis),
        )

    def _out(self, axis: int) -> float:
        return -response(self._axes.get(axis, 0.0), self.scheme.dead_zone)


def response(value: float, dead_zone: float) -> float:
    """Return -1 to 1 for how far out an axis is, in proportion beyond the dead zone.

    NaN counts as the middle. The page's `response.js` does the same.
    """
    if not abs(value) > dead_zone:
        return 0.0
    part = (min(1.0, abs(value)) - dead_zone) / (1.0 - dead_zone)
    return part if value > 0 else -part
