"""The page's side of the robot: one wheel for all visitors."""

import asyncio
from dataclasses import replace
from typing import Any

from pioneer3 import __version__
from pioneer3.behaviors.actions import Hold
from pioneer3.geometry import Twist2
from pioneer3.runtime.priorities import WEB
from pioneer3.runtime.robot import Robot
from pioneer3.runtime.scene import Scene
from pioneer3.state import Snapshot
from pioneer3.teleop.lease import Lease
from pioneer3.web import messages, requests
from pioneer3.web.editor import Editor, refusal
from pioneer3.web.world import WorldView

EXPIRY = 0.5
"""A page that falls silent drives this much longer [s]."""


class Page:
    """What every visitor shares: the robot, the scene around it, and the wheel.

    Attributes:
        robot: What is driven.
        world: What surrounds it and can be changed; `None` for a real robot.
    """

    def __init__(self, robot: Robot, scene: Scene) -> None:
        self.robot = robot
        self._scene = scene
        self._hold = Hold("web")
        self._lease: Lease[object] = Lease()
        self._clock = asyncio.get_running_loop().time
        self.world = WorldView(*scene.simulated) if scene.simulated else None
        self._editor = Editor(self.world, self._take_wheel, robot.helm.stop) if self.world else None
        robot.helm.add(self._hold, WEB)

    def drive(self, who: object, twist: Twist2) -> str | None:
        """Let `who` hold `twist`, a zero one lets go; return why not, or `None`."""
        if not self._take_wheel(who):
            return "somebody else drives"
        if twist.is_zero:
            self.robot.helm.release(self._hold)
        else:
            refused = self.robot.helm.hold(self._hold, twist, EXPIRY)
            if self._hold.muted:
                return refused
        return None

    def stop(self, who: object) -> None:
        """Stop for `who`; what anybody else holds must be let go before it counts again."""
        mine = self._lease.holder(self._clock()) is who
        self.robot.helm.stop(by=self._hold if mine else None)

    def let_go(self, who: object) -> None:
        """Take the wheel from `who`, who is gone: the robot stops at once."""
        if self._lease.holder(self._clock()) is who:
            self._lease.give_up(who)
            self.robot.helm.release(self._hold)

    def driver(self) -> object | None:
        """Return the visitor who drives, or anything else if it is not one; `None` for nobody."""
        name = self.robot.helm.driver
        return self._lease.holder(self._clock()) if name == self._hold.name else name

    async def edit(self, who: object, edit: requests.Edit) -> dict[str, Any] | None:
        """Change the simulated world for `who`; return the answer, if there is one."""
        if self._editor is None:
            return refusal("only a simulated world can be changed here")
        return await self._editor.obey(who, edit)

    def hello(self) -> dict[str, Any]:
        """Return what a page needs to draw this robot."""
        info, scene, world = self.robot.supervisor.info, self._scene, self.world
        if world is None:
            return messages.hello(__version__, info, scene)
        here = replace(scene, map=world.simulation.world.map)  # clients may load another
        return messages.hello(__version__, info, here, world.models)

    def status(self) -> dict[str, Any]:
        """Return how it stands with the link."""
        status = self.robot.supervisor.status.latest
        assert status is not None
        return {"type": "status", "state": status.connection.value, "message": status.message}

    def snapshot(self, snapshot: Snapshot, driver: Any) -> dict[str, Any]:
        """Return the message for a visitor to whom the driver is `you`, `other` or `None`."""
        helm = self.robot.helm
        return messages.snapshot(
            snapshot,
            pose=self._scene.robot_in_map(snapshot.odometry.robot_in_odom),
            why=self.robot.why_not_moving(),
            mode=helm.mode.name if helm.mode else None,
            decided=helm.told if helm.mode else (),
            emergency_stop=self.robot.supervisor.pilot.emergency,
            driver=driver,
        )

    def _take_wheel(self, who: object) -> bool:
        """Give the wheel to `who` if it is free or theirs; return whether it is theirs now."""
        return self._lease.take(who, self._clock())
