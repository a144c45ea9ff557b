"""The one place where wishes become velocities: actions in, one request to the robot out."""

import asyncio

from pioneer3.behaviors.actions import Hold
from pioneer3.behaviors.engine import Action, Decision, resolve
from pioneer3.geometry import STILL, Twist2
from pioneer3.robot.supervisor import Supervisor


class Helm:
    """Asks every action and tells the robot, at each snapshot and at each change."""

    def __init__(self, supervisor: Supervisor) -> None:
        self.decision = Decision(STILL)
        self._supervisor = supervisor
        self._actions: list[Action] = []
        self._clock = asyncio.get_running_loop().time

    @property
    def driver(self) -> str | None:
        """Name of the action that drives, or `None`."""
        if self._clock() >= self.decision.until:
            return None
        return self.decision.v_by or self.decision.w_by

    async def run(self) -> None:
        """Decide anew at each snapshot, for as long as the supervisor lives."""
        async for _ in self._supervisor.snapshots.values():
            self.decide(renewed=True)

    def decide(self, *, renewed: bool = False) -> str | None:
        """Resolve now; return why the robot ignores the result, or `None`.

        `renewed` says that nobody has asked for anything new: only time has passed.
        """
        snapshot, now, before = self._supervisor.snapshot, self._clock(), self.decision
        if snapshot is None:
            return self._supervisor.why_not_moving()
        self.decision = resolve(self._actions, snapshot, now)
        if self.decision.wanted:
            twist, until = self.decision.twist, self.decision.until
            return self._supervisor.drive(twist, until, renewed=renewed)
        if before.wanted and now < before.until:  # let go; what expires, the pilot ends itself
            return self._supervisor.drive(STILL)
        return None

    def add(self, action: Action) -> None:
        """Let `action` take part from now on."""
        self._actions.append(action)

    def remove(self, action: Action) -> None:
        """Take `action` out; what it wanted ends at once."""
        if action in self:
            self._actions = [a for a in self._actions if a is not action]
            self.decide()

    def __contains__(self, action: Action) -> bool:
        return any(a is action for a in self._actions)

    def hold(self, held: Hold, twist: Twist2, seconds: float) -> str | None:
        """Let `held` want `twist` for `seconds`; return why the robot ignores it, or `None`."""
        held.set(twist, self._clock(), seconds)
        if held.muted:
            return "somebody stopped the robot; let go, then ask again"
        if self._supervisor.snapshot is None:  # refused, but noted: a held key is not a fresh one
            return self._supervisor.drive(twist)
        return self.decide()

    def release(self, held: Hold) -> None:
        """Let go; the robot stops if nobody else drives."""
        held.release()
        self.decide()

    def stop(self, by: Hold | None = None) -> None:
        """End every wish and stand still; what others than `by` hold must be let go first."""
        self._end_wishes(by)
        self._supervisor.stop()

    def emergency_stop(self) -> None:
        """End every wish and stop hard, latched."""
        self._end_wishes(None)
        self._supervisor.emergency_stop()

    def set_motors(self, *, on: bool, by: Hold | None = None) -> str | None:
        """Stop as :meth:`stop` does, then switch the motors; return why not, or `None`."""
        self.stop(by)
        return self._supervisor.set_motors(on=on)

    def _end_wishes(self, by: Hold | None) -> None:
        holds = [action for action in self._actions if isinstance(action, Hold)]
        for hold in holds:
            if hold is by:
                hold.release()
            else:
                hold.mute(self._clock())
        self._actions = list(holds)
        self.decision = Decision(STILL)
