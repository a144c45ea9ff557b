"""The robot for scripts and notebooks: the same, without `await`."""

from contextlib import AbstractAsyncContextManager
from typing import Any, cast

from pioneer3.geometry import Pose2
from pioneer3.navigation.notebook import LiveView, after_failed_cells, leave
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.runtime.blocking import BlockingConnection
from pioneer3.runtime.facade import adapted, blocking
from pioneer3.runtime.robot import Robot
from pioneer3.state import Snapshot


class BlockingRobot(BlockingConnection):
    """A :class:`pioneer3.Robot` on an event loop in a thread of its own.

    A notebook shows it as a picture, and its robot stops when a cell fails or is interrupted.
    """

    def __init__(self, connection: AbstractAsyncContextManager[Robot], url: str = "") -> None:
        self.url = url
        leave(url)
        super().__init__(connection)
        self._forget_cells = after_failed_cells(self._stop_soon)
        self._view: LiveView | None = None

    @property
    def info(self) -> RobotInfo:
        """Identity, model, limits and configuration of the robot last connected."""
        return cast("RobotInfo", self._read("info"))

    @property
    def snapshot(self) -> Snapshot | None:
        """The latest snapshot, or `None` while the link is lost."""
        return cast("Snapshot | None", self._read("snapshot"))

    @property
    def odom_in_map(self) -> Pose2 | None:
        """Pose of odometry's frame on the map; `None` where it is not surely known."""
        return cast("Pose2 | None", self._read("odom_in_map"))

    @property
    def devices(self) -> Any:
        """The devices besides wheels and sonars: :class:`pioneer3.robot.devices.Devices`.

        Facades, made as they are asked for: `robot.devices.gripper.open()`, or
        `for scan in robot.devices.laser.values()`. Their types are known when the program runs.
        """
        return adapted(self._target.devices, self._thread)

    @property
    def navigator(self) -> Any:
        """Knows where the robot is on a map, as a facade; `None` without a map."""
        return adapted(self._target.navigator, self._thread)

    @property
    def shadow(self) -> Any:
        """Its simulated twin, as a facade; `None` where none was asked for."""
        return adapted(self._target.shadow, self._thread)

    @property
    def laser(self) -> Any:
        """The first of :attr:`lasers`."""
        return self.lasers[0]

    @property
    def lasers(self) -> tuple[Any, ...]:
        """The laser range finders, as facades: `robot.lasers[0].reading()`."""
        return tuple(adapted(laser, self._thread) for laser in self._target.lasers)

    def view(self) -> LiveView:
        """Show the robot below this cell of a notebook, live, until it is closed or shown anew.

        The cell ends at once, and the next one may drive. `with robot.view():` shows a block.

        Raises:
            ConfigError: This is no notebook.
        """
        if self._view is not None:
            self._view.close()
        self._view = LiveView(self._target, self._thread)
        return self._view

    def close(self) -> None:
        """End the session, the robot stops; safe to call twice, and in any thread.

        In a process that was forked from the one that connected it does nothing.
        """
        getattr(self, "_forget_cells", int)()
        super().close()

    def _repr_html_(self) -> str:
        """Return the robot as a notebook shows it; see :mod:`pioneer3.navigation.picture`."""
        from pioneer3.navigation.picture import card  # loads numpy, here and not in the loop

        try:
            return self._thread.call(lambda: card(self._target))
        except RuntimeError as error:  # it is closed, or belongs to another process
            return f"<p>{error}</p>"

    snapshots = blocking(Robot.snapshots)
    drive = blocking(Robot.drive)
    drive_wheels = blocking(Robot.drive_wheels)
    stop = blocking(Robot.stop)
    emergency_stop = blocking(Robot.emergency_stop)
    reset_emergency_stop = blocking(Robot.reset_emergency_stop)
    motors = blocking(Robot.motors)
    move = blocking(Robot.move)
    turn = blocking(Robot.turn)
    start_move = blocking(Robot.start_move)
    set_delta_heading = blocking(Robot.set_delta_heading)
    set_heading = blocking(Robot.set_heading)
    is_move_done = blocking(Robot.is_move_done)
    goto = blocking(Robot.goto)
    run = blocking(Robot.run)
    nearest = blocking(Robot.nearest)
    why_not_moving = blocking(Robot.why_not_moving)
    send = blocking(Robot.send)
    send_unsafe = blocking(Robot.send_unsafe)

    def _stand(self) -> None:
        """Stop the robot in the loop, also when others drive."""
        if self._target is not None:
            self._target.arbiter.stop()

    def _stop_soon(self) -> None:
        self._thread.loop.call_soon_threadsafe(self._stand)
