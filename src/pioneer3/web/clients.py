"""The clients that are connected to a page, and their control of its robots."""

from collections.abc import Mapping
from itertools import count
from typing import Protocol

from pioneer3.log.writer import LogWriter
from pioneer3.web import messages
from pioneer3.web.access.sessions import LoginSession, Role
from pioneer3.web.broadcast import Subscriber
from pioneer3.web.control import Operator
from pioneer3.web.robot_view import RobotView


class PageClient(Operator, Subscriber, Protocol):
    """A client of the page. Clients are compared by identity."""

    @property
    def role(self) -> Role:
        """The permissions of the client."""

    @property
    def session(self) -> LoginSession:
        """The session that the client belongs to."""

    def tell(self, news: str) -> None:
        """Show `news`."""

    def show(self, message: messages.Message) -> None:
        """Send `message` to this client alone."""


class Clients:
    """The connected clients of a page, by number; a number is never used again.

    The version counts the changes of the clients and of the operators who have control. The log is
    told them, and what clients are told.
    """

    def __init__(self, robots: Mapping[int, RobotView]) -> None:
        self.connected: dict[int, PageClient] = {}
        self.version = 0
        self.log: LogWriter | None = None
        self._robots = robots
        self._count = count(1)
        self._holders: tuple[messages.Holder, ...] = ()
        self._clients: tuple[messages.ClientInfo, ...] = ()

    def add(self, client: PageClient) -> int:
        """Add `client`; return its number."""
        number = next(self._count)
        self.connected[number] = client
        return number

    def update(self) -> bool:
        """Compare the clients with the last update; return whether anything has changed."""
        clients = tuple(
            messages.ClientInfo(number, client.name, client.role)
            for number, client in self.connected.items()
        )
        holders = tuple(
            messages.Holder(view.number, self.number_of(holder), holder.name)
            for view in self._robots.values()
            if (holder := view.control.holder) is not None
        )
        if (holders, clients) == (self._holders, self._clients):
            return False
        self._note_changes(holders, clients)
        self._holders, self._clients = holders, clients
        self.version += 1
        return True

    def note(self, kind: str, text: str) -> None:
        """Put an event into the log, if there is one."""
        if self.log is not None:
            self.log.event(kind, text)

    def _note_changes(
        self, holders: tuple[messages.Holder, ...], clients: tuple[messages.ClientInfo, ...]
    ) -> None:
        """Note who came, took control, lost it and left."""
        before = {each.id: each.name for each in self._clients}
        now = {each.id: each.name for each in clients}
        for each in clients:
            if each.id not in before:
                self.note("page", f"{each.name} came, a {each.role}")
            elif each.name != before[each.id]:
                self.note("page", f"{before[each.id]} is called {each.name} now")
        for holder in self._holders:
            if holder not in holders:
                self.note("page", f"{holder.name} lost control of {self._called(holder.robot)}")
        for holder in holders:
            if holder not in self._holders:
                self.note("page", f"{holder.name} took control of {self._called(holder.robot)}")
        for number in before.keys() - now.keys():
            self.note("page", f"{before[number]} left")

    def _called(self, robot: int) -> str:
        """Return the name of a robot, which may have gone."""
        return self._robots[robot].label if robot in self._robots else f"robot {robot}"

    @property
    def names(self) -> set[str]:
        """The names of all clients."""
        return {client.name for client in self.connected.values()}

    def tell(self, robot: int, operator: Operator, news: str) -> None:
        """Show news about a robot to an operator that is a client, with the name where several are.

        A student sees one robot only.
        """
        client = self.find(operator)
        if client is not None:
            named = len(self._robots) > 1 and client.role is not Role.STUDENT
            client.tell(f"{self._robots[robot].label}: {news}" if named else news)

    def show(self, operator: Operator, message: messages.Message) -> None:
        """Send `message` to an operator that is a client."""
        client = self.find(operator)
        if client is not None:
            client.show(message)

    def take_control(self, client: object, robot: int | None) -> bool:
        """Give `client` control of a robot, or of all without a number; return whether it has it.

        It gets control of all of them or of none.
        """
        operator = self.find(client)
        wanted = self._robots.values() if robot is None else [self._robots[robot]]
        controls = [view.control for view in wanted]
        if operator is None or any(each.holder not in (None, operator) for each in controls):
            return False
        return all(each.take(operator) is None for each in controls)

    def release_control(self, operator: Operator) -> None:
        """End the control of `operator` over all robots; those that the operator drives stop."""
        for view in self._robots.values():
            view.release(operator)

    def keep_alive(self, operator: Operator) -> None:
        """Note that the client of `operator` is alive."""
        for view in self._robots.values():
            view.control.keep_alive(operator)

    def message_for(self, number: int) -> str:
        """Return the message about all clients, for the client of this number.

        Students are told about themselves, and who has control of their own robot.
        """
        you = self.connected[number]
        holders, clients = self._holders, self._clients
        if you.role is Role.STUDENT:
            holders = tuple(each for each in holders if each.robot == you.session.robot)
            clients = (messages.ClientInfo(number, you.name, you.role),)
        return messages.encode(messages.People(number, you.name, you.role, holders, clients))

    def of_session(self, session: str) -> int:
        """Return how many clients belong to the session of this id."""
        return sum(client.session.id == session for client in self.connected.values())

    def number_of(self, operator: object) -> int | None:
        """Return the number of an operator that is a client, or `None`."""
        return next((n for n, client in self.connected.items() if client is operator), None)

    def find(self, operator: object) -> PageClient | None:
        """Return `operator` if it is a client."""
        return next((client for client in self.connected.values() if client is operator), None)
