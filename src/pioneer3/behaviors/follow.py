"""The mode that follows somebody."""

from typing import Literal, get_args

from pioneer3.behaviors.action import MODE, Action, Ranked, Stack
from pioneer3.behaviors.actions.follow import FollowLab, FollowTracking
from pioneer3.behaviors.actions.limiters import Brake, LimiterBackwards, LimiterTableSensor

Rule = Literal["tracking", "lab"]
HINT = "follows the person in front, at arm's length"
RULES: tuple[str, ...] = get_args(Rule)


def follow(rule: Rule = "tracking", *, keep: float | None = None, priority: int = MODE) -> Stack:
    """Return the mode that follows the person in front.

    Both rules are held back alike: by :class:`Brake` ahead, as the other limiters would keep the
    robot from where the person has just been, and by ARIA's limiter behind.

    Args:
        rule: `lab` goes to the nearest echo, `tracking` to whom it has been following.
        keep: Distance to keep [m]; from the transducer for `lab`, from the robot's front end for
            `tracking`; 0.3 unless given.
        priority: Against other stacks.

    Raises:
        ValueError: there is no such rule.
    """
    action: Action
    match rule:
        case "lab":
            action = FollowLab() if keep is None else FollowLab(keep=keep)
        case "tracking":
            action = FollowTracking() if keep is None else FollowTracking(keep=keep)
        case _:
            raise ValueError(f"follow: no rule is called {rule!r}, but {' and '.join(RULES)} are")
    actions = [
        Ranked(100, LimiterTableSensor()),
        Ranked(90, Brake()),
        Ranked(80, LimiterBackwards()),
        Ranked(50, action),
    ]
    return Stack.of("follow", priority, actions, HINT)
