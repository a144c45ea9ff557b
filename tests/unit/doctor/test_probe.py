"""Which port to use, and which to leave alone."""

import asyncio
from collections.abc import Sequence

import pytest

from pioneer3.doctor import probe
from pioneer3.doctor.ports import PortHolder, SerialPort
from pioneer3.doctor.probe import (
    Probed,
    ProbeVerdict,
    came_back,
    choose,
    found_code,
    not_probed,
    probe_all,
    skipped,
    wait_for_plug,
)
from pioneer3.errors import PortNotFoundError
from pioneer3.links import Link
from pioneer3.links.memory import null_modem
from pioneer3.links.serial import SPEEDS

USB0 = SerialPort(path="/dev/serial/by-id/usb-A", device="/dev/ttyUSB0")
USB1 = SerialPort(path="/dev/serial/by-id/usb-B", device="/dev/ttyUSB1")
USB0_AS_1 = SerialPort(path="/dev/serial/by-id/usb-A", device="/dev/ttyUSB1")
ROBOT = Probed("/dev/ttyUSB0", ProbeVerdict.ROBOT)
SIMULATOR = Probed("tcp://localhost:8101", ProbeVerdict.SIMULATOR)
SILENT = Probed("/dev/ttyS0", ProbeVerdict.SILENT)


def test_a_real_robot_is_preferred_to_a_forgotten_simulator() -> None:
    assert choose([SIMULATOR, SILENT, ROBOT]) is ROBOT
    assert choose([SILENT, SIMULATOR]) is SIMULATOR
    assert choose([SILENT]) is None


def test_the_first_of_two_robots_is_chosen() -> None:
    assert choose([ROBOT, Probed("/dev/ttyUSB1", ProbeVerdict.ROBOT)]) is ROBOT


@pytest.mark.parametrize(
    ("port", "verdict"),
    [
        (SerialPort(path="p", device="p", holders=(PortHolder(7, "screen"),)), ProbeVerdict.BUSY),
        (SerialPort(path="p", device="p", console=True), ProbeVerdict.CONSOLE),
        (SerialPort(path="p", device="p", vendor_id=0x15D1, product_id=0), ProbeVerdict.LASER),
    ],
)
def test_ports_in_use_consoles_and_lasers_by_name_are_not_spoken_to(
    port: SerialPort, verdict: ProbeVerdict
) -> None:
    judged = skipped(port)
    assert judged is not None
    assert judged.verdict is verdict


def test_any_other_port_is_to_be_asked() -> None:
    assert skipped(USB0) is None


def test_the_exit_code_says_whether_a_robot_was_found() -> None:
    assert found_code([SILENT, ROBOT]) == 0
    assert found_code([SILENT]) == 3
    assert found_code([]) == 3
    assert found_code(not_probed([USB0], ["tcp://localhost:8101"])) == 0


def test_the_port_that_vanished_and_appeared_comes_first() -> None:
    assert came_back((USB0, USB1), (USB1,), (USB0, USB1)) == (USB0,)
    assert came_back((USB0,), (), (USB1, USB0)) == (USB0, USB1)
    assert came_back((USB0,), (), ()) == ()


def test_a_port_that_comes_back_with_another_number_is_found() -> None:
    assert came_back((USB0,), (), (USB0_AS_1,)) == (USB0_AS_1,)


async def test_plugging_in_is_waited_for() -> None:
    loop = asyncio.get_running_loop()
    began = loop.time()
    found = await wait_for_plug(
        (USB0,), (), lambda: (USB0,) if loop.time() - began > 3 else (), patience=10
    )
    assert found == (USB0,)
    assert 3 < loop.time() - began < 5


async def test_waiting_for_a_plug_ends() -> None:
    assert await wait_for_plug((USB0,), (), tuple, patience=2) == ()


@pytest.fixture
def silent_ports(monkeypatch: pytest.MonkeyPatch) -> None:
    """Serial ports where nothing ever answers; nobody listens in the network."""

    async def open_link(url: str) -> Link:
        if url.startswith("tcp:"):
            raise PortNotFoundError(f"{url}: nobody listens")
        return null_modem(speeds=SPEEDS)[0]

    monkeypatch.setattr(probe, "open_link", open_link)


@pytest.mark.usefixtures("silent_ports")
async def test_many_silent_ports_take_no_longer_than_one() -> None:
    clock = asyncio.get_running_loop().time
    began = clock()
    await probe_all([USB0])
    alone = clock() - began
    assert alone > 5.0  # all speeds, first for a robot, then for a laser
    began = clock()
    found = await probe_all([SerialPort(path=f"/dev/ttyS{n}", device="") for n in range(8)])
    assert clock() - began == pytest.approx(alone, abs=0.1)
    assert {each.verdict for each in found} == {ProbeVerdict.SILENT}


@pytest.mark.usefixtures("silent_ports")
async def test_results_keep_the_order_of_the_ports_and_progress_says_who_is_left() -> None:
    held = SerialPort(path="/dev/ttyS0", device="/dev/ttyS0", holders=(PortHolder(7, "screen"),))
    left: list[Sequence[str]] = []
    found = await probe_all([USB0, held, USB1], ["tcp://localhost:8101"], left.append)
    assert [(each.url, each.verdict) for each in found] == [
        (USB0.path, ProbeVerdict.SILENT),
        (held.path, ProbeVerdict.BUSY),
        (USB1.path, ProbeVerdict.SILENT),
        ("tcp://localhost:8101", ProbeVerdict.NOBODY),
    ]
    assert left[0] == (USB0.path, held.path, USB1.path, "tcp://localhost:8101")
    assert left[1] == (USB0.path, USB1.path, "tcp://localhost:8101")
    assert left[2] == (USB0.path, USB1.path)
    assert left[-1] == ()
