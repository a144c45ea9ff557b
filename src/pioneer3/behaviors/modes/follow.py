"""The mode that follows a person."""

from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from msgspec import Meta

from pioneer3.behaviors.modes.mode import Choice, Choices, Distance, Mode

if TYPE_CHECKING:
    from pioneer3.behaviors.action import Action, Stack
    from pioneer3.limits import Limits

Rule = Literal["auto", "legs", "tracking", "lab"]
RULES = Choices(
    (
        Choice("auto", "Automatic", "by the legs while a laser works, else tracking"),
        Choice("legs", "Legs", "remembers the legs it follows in a laser's scans"),
        Choice("tracking", "Tracking", "remembers the echoes it follows"),
        Choice("lab", "Lab", "goes to the nearest echo, as the lab's node"),
    )
)


class Follow(Mode, frozen=True, tag="follow"):
    """Follow the person in front by laser or sonar.

    It backs up from a person who comes nearer. Stand 0.6 m in front of it, then walk, not faster
    than 0.4 m/s.
    """

    title: ClassVar[str] = "Follow"
    doing: ClassVar[str] = "follows the person in front"
    start: ClassVar[str] = "Start following"
    example: ClassVar[str] = "--port /dev/ttyUSB0"

    rule: Annotated[Rule, Meta(title="Rule"), RULES] = "auto"
    keep: Annotated[
        Distance | None,
        Meta(title="Distance to keep", description="Distance to keep; 0.3 unless given."),
    ] = None

    def stack(self, limits: "Limits") -> "Stack":
        """Return a fresh stack that follows; no rule is faster than 0.5 m/s."""
        return follow(self.rule, keep=self.keep)


def follow(rule: Rule = "auto", *, keep: float | None = None) -> "Stack":
    """Return the stack that follows the person in front by one of :data:`RULES`.

    It keeps the distance `keep` [m]; from the transducer for `lab`, from the robot's front end for
    the others; 0.3 unless given.

    Raises:
        ValueError: there is no such rule.
    """
    from pioneer3.behaviors.actions.follow import FollowLab, FollowTracking
    from pioneer3.behaviors.trackers import TRACKERS

    if rule not in RULES.names:
        names = " and ".join(RULES.names)
        raise ValueError(f"follow: no rule is called {rule!r}, but {names} are")
    distance = 0.3 if keep is None else keep
    action: Action = FollowLab(keep=distance)
    if rule != "lab":
        scans = rule in {"auto", "legs"}
        action = FollowTracking(keep=distance, tracker=TRACKERS[rule](), wants_scans=scans)
    return guarded("follow", Follow.doing, action)


def guarded(name: str, doing: str, action: "Action") -> "Stack":
    """Return the stack of an action that follows, held back by `Brake` ahead.

    The other limiters would keep the robot from where the one ahead has just been; behind, ARIA's
    holds it back.
    """
    from pioneer3.behaviors.action import MODE, Ranked, Stack
    from pioneer3.behaviors.actions.limiters import Brake, LimiterBackwards, LimiterTableSensor

    actions = [
        Ranked(100, LimiterTableSensor()),
        Ranked(90, Brake()),
        Ranked(80, LimiterBackwards()),
        Ranked(50, action),
    ]
    return Stack.of(name, MODE, actions, doing)
