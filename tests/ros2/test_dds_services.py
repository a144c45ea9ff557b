"""Services over DDS beside a program that has rmw_cyclonedds_cpp's header, and no more."""

import asyncio
import signal
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest

from pioneer3.ros.ros2.network import BackendName
from tests.e2e.processes import until
from tests.ros2.conftest import Robot, robot_on
from tests.ros2.dds_network import Message, Program, program_on
from tests.ros2.networks import network_of

pytestmark = [pytest.mark.realtime]
REQUEST, REPLY = "rq/sonar/enableRequest", "rr/sonar/enableReply"
SET_BOOL = "std_srvs/srv/SetBool"
CLIENT = 0x0123_4567_89AB_CDEF
OTHER = (1 << 64) - 1


@asynccontextmanager
async def client(*options: str) -> AsyncIterator[tuple[Robot, Program, list[Message]]]:
    """Run a robot, and a program that may call its service; yield the replies, too."""
    async with (
        network_of(BackendName.DDS) as network,
        program_on(network) as program,
        robot_on(network, *options) as robot,
    ):
        replies = await program.reader(REPLY, f"{SET_BOOL}_Response", depth=1000)
        await program.writer(REQUEST, f"{SET_BOOL}_Request", depth=1000)
        yield robot, program, replies


def asked(number: int, identity: int = CLIENT, *, data: bool = False) -> dict[str, object]:
    return {"client_id": identity, "sequence": number, "data": data}


def ask(program: Program, number: int, identity: int = CLIENT, *, data: bool = False) -> None:
    program.do("send", key=REQUEST, fields=asked(number, identity, data=data))


def numbers(replies: list[Message], identity: int) -> set[int]:
    return {each.fields["sequence"] for each in replies if each.fields["client_id"] == identity}


async def test_replies_name_their_request_and_its_client() -> None:
    async with client("--dds-services") as (_, program, replies):
        await program.send_until(lambda: replies, REQUEST, fields=asked(1))
        assert replies[0].fields["success"] is True
        for number in range(2, 30):
            ask(program, number, data=bool(number % 2))
            ask(program, -number, OTHER)
        wanted = set(range(1, 30)), {-number for number in range(2, 30)}
        await until(lambda: (numbers(replies, CLIENT), numbers(replies, OTHER)) == wanted)


async def test_requests_that_are_none_are_left_out() -> None:
    async with client("--dds-services") as (robot, program, replies):
        await program.send_until(lambda: replies, REQUEST, fields=asked(1))
        header = b"\0\1\0\0"
        for length in (0, 4, 8, 12, 16, 20, 24, 400, 40_000):
            program.do("send_raw", key=REQUEST, cdr=(header + b"\xff" * length).hex())
        program.do("send_raw", key=REQUEST, cdr=(b"\0\7\0\0" + bytes(20)).hex())
        ask(program, 77)
        await until(lambda: 77 in numbers(replies, CLIENT))
        _, errors = await robot.node.end(signal.SIGINT)
        assert "Traceback" not in errors
        assert errors.count("requests of /sonar/enable cannot be read") == 1


@pytest.mark.parametrize("distro", ["humble", "jazzy"])
async def test_services_are_not_there_unless_somebody_asks_for_them(distro: str) -> None:
    """A peer with Fast DDS would hang as soon as it calls one."""
    async with client("--distro", distro) as (_, program, replies):
        await until(lambda: program.endpoints("rt/sonar/enable", "subscription"))
        ask(program, 1)
        await asyncio.sleep(1.0)
        topics = {each.get("topic", "") for each in program.found.values()}
        own = {REQUEST, REPLY}
        assert not {topic for topic in topics - own if topic.startswith(("rq/", "rr/"))}
        assert not program.endpoints(REQUEST, "subscription")
        assert not program.endpoints(REPLY)
        assert replies == []
