"""Starts a mode of several robots: gives each its place, or the reason not to start."""

from collections.abc import Mapping, Sequence
from functools import partial
from itertools import combinations

from pioneer3.behaviors.action import Stack
from pioneer3.behaviors.actions.keep_apart import least_spacing
from pioneer3.behaviors.formations import assigned
from pioneer3.behaviors.modes.group import GroupMode, Membership
from pioneer3.errors import MotionError
from pioneer3.navigation.traffic import Traffic
from pioneer3.runtime.driven import Driven
from pioneer3.units import LENGTH


def stacks_of(
    mode: GroupMode, robots: Mapping[str, Driven], leader: str | None, traffic: Traffic
) -> dict[str, Stack]:
    """Return a fresh stack for each robot of a group, by name; the leader, if any, has none.

    All have joined `traffic`.

    Raises:
        MotionError: They cannot drive together; see the message.
    """
    names = [name for name in robots if name != leader or not mode.led]
    _check(mode, robots, leader, traffic)
    order = [*range(len(names))]
    if mode.led and leader:
        order = _order(mode, names, leader, robots[leader], traffic)
    return {
        name: mode.stack(
            Membership(
                leader=leader or "",
                number=order[at] + 1,
                peers=partial(traffic.peers_of, name),
            ),
            robots[name].info.limits,
        )
        for at, name in enumerate(names)
    }


def _check(
    mode: GroupMode, robots: Mapping[str, Driven], leader: str | None, traffic: Traffic
) -> None:
    """Refuse a group that cannot be driven."""
    title = mode.title.lower()
    if len(robots) < 2:
        raise MotionError(f"{title}: one robot is no group; choose two or more")
    if mode.led and leader not in robots:
        raise MotionError(f"{title}: no leader is named; choose one of {', '.join(robots)}")
    for name in robots:
        if why := traffic.unknown(name):
            raise MotionError(f"{title}: it is not known where {name} is: {why}")
    if not traffic.share_frame([*robots]):
        raise MotionError(f"{title}: the robots are not in one world, or not on one map")
    models = [robot.info.model for robot in robots.values()]
    least = max(least_spacing(one, other) for one, other in combinations(models, 2))
    if mode.nearest < least:
        raise MotionError(
            f"{title}: {LENGTH.written(mode.nearest)} from robot to robot is too near; these need "
            f"{LENGTH.written(round(least + 0.005, 2))} or more"
        )


def _order(
    mode: GroupMode, names: Sequence[str], leader: str, robot: Driven, traffic: Traffic
) -> list[int]:
    """Return the place of each follower, from 0."""
    seen = {peer.name: peer.pose for peer in traffic.peers_of(leader)}
    snapshot = robot.snapshot
    if snapshot is None or any(name not in seen for name in names):
        raise MotionError(f"{mode.title.lower()}: a robot has just been lost; try again")
    to_leader = snapshot.odometry.robot_in_odom.inverse()
    behind = [to_leader @ seen[name] for name in names]
    return assigned([(pose.x, pose.y) for pose in behind], mode.places(len(names)))
