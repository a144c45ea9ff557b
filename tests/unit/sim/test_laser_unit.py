"""A simulated laser in time: its turns, its power, its cable; hosts are in memory."""

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.models.lasers import LASERS, LaserProtocol
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.server import laser_hosts
from pioneer3.sim.server.clients import HostConnection
from pioneer3.sim.server.faults import LinkFaults
from pioneer3.sim.server.laser import SimulatedLaser
from pioneer3.sim.world import World
from tests.unit.sim.fake_laser import FakeDevice

TICK = 0.02


class Host:
    """A host in memory."""

    def __init__(self, *, permanent: bool = False, peer: str = "memory") -> None:
        self.permanent, self.peer = permanent, peer
        self.full = False
        self.heard = b""
        self.closed = False

    def resume(self) -> None:
        pass

    def pause(self) -> None:
        pass

    def send(self, data: bytes) -> None:
        self.heard += data

    def close(self) -> None:
        self.closed = True

    @property
    def lines(self) -> list[list[int]]:
        """The scans it has got."""
        return [[int(word) for word in line.split()] for line in self.heard.splitlines()]


class Bench:
    """A laser on a robot in front of a wall, ticked by hand."""

    def __init__(self, name: str, tick: float = TICK) -> None:
        body = Body(load_model("p3dx-sh"), Pose2())
        walls = np.array([[3.021, -9.0, 3.021, 9.0]])
        self.world = World(LineMap(name="wall", walls=walls), [body], Kernels())
        self.device = FakeDevice(LASERS[name])
        self.laser = SimulatedLaser(self.world, body, LASERS[name], self.device)
        self.tick = tick

    def connect(self, host: HostConnection | None = None) -> Host:
        """Connect a host."""
        made = Host() if host is None else host
        self.laser.hosts.admit(made)
        assert isinstance(made, Host)
        return made

    def send(self, host: Host, data: bytes) -> None:
        self.laser.hosts.received(host, data)

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / self.tick)):
            self.laser.exchange(self.world.time)
            self.world.step(self.tick)
            self.laser.tick(self.world.time)


@pytest.mark.parametrize("name", ["utm-30lx", "lms-200", "lms-111", "urg-04lx"])
@pytest.mark.parametrize("tick", [0.005, 0.02, 0.1])
async def test_turns_follow_each_other_without_gaps(name: str, tick: float) -> None:
    bench = Bench(name, tick)
    host = bench.connect()
    bench.send(host, b"S")
    bench.run(1.0)
    model = LASERS[name]
    began = np.array([sweep.began for sweep in bench.device.sweeps])
    assert began[0] == 0.0
    assert np.diff(began) == pytest.approx(model.turn, abs=1e-9)
    assert len(began) == pytest.approx(1.0 / model.turn, abs=1 + tick / model.turn)
    assert all(line[3] == 3000 for line in host.lines)


@pytest.mark.parametrize("name", ["utm-30lx", "lms-200", "tim551"])
@pytest.mark.parametrize("tick", [0.005, 0.02, 0.1])
async def test_a_turn_is_handed_in_at_the_exact_time_of_its_last_reading(
    name: str, tick: float
) -> None:
    bench = Bench(name, tick)
    host = bench.connect()
    bench.send(host, b"S")
    bench.run(0.6)
    model = LASERS[name]
    lasts = (model.count - 1) * model.turn * model.step / (2 * np.pi)
    assert len(host.lines) == pytest.approx(0.6 / model.turn, abs=1 + tick / model.turn)
    for began, handed_in, _, _ in host.lines:
        assert handed_in - began == pytest.approx(1e6 * lasts, abs=2)


async def test_a_turn_reaches_the_host_in_the_tick_in_which_it_ends() -> None:
    bench = Bench("utm-30lx")
    host = bench.connect()
    bench.send(host, b"S")
    seen = 0
    for _ in range(50):
        bench.run(TICK)
        for _, ended, _, _ in host.lines[seen:]:
            assert bench.world.time - TICK - 1e-6 <= ended / 1e6 <= bench.world.time + 1e-6
        seen = len(host.lines)
    assert seen >= 38


async def test_nothing_is_measured_while_nobody_wants_it() -> None:
    bench = Bench("utm-30lx")
    host = bench.connect()
    bench.send(host, b"?")
    bench.run(0.2)
    assert host.heard == b"!"
    assert bench.device.sweeps == []
    bench.send(host, b"S")
    bench.run(0.2)
    assert bench.device.sweeps[0].began == pytest.approx(0.2)
    bench.send(host, b"Q")
    bench.run(0.1)
    before = len(bench.device.sweeps)
    bench.run(0.1)
    assert len(bench.device.sweeps) == before


async def test_a_serial_line_has_one_connection_for_ever() -> None:
    bench = Bench("urg-04lx")
    (line,) = bench.device.connections
    first = bench.connect()
    bench.send(first, b"S")
    bench.run(0.1)
    bench.laser.hosts.disconnected(first)
    bench.run(0.1)
    assert line.streams  # it does not know that the host has gone
    second = bench.connect()
    bench.run(0.2)
    assert second.lines
    assert bench.device.connections == [line]


async def test_a_host_in_the_network_gets_nothing_that_was_for_the_last_one() -> None:
    for name in ("urg-04lx", "utm-30lx"):
        bench = Bench(name)
        first = bench.connect()
        bench.send(first, b"??")
        bench.laser.hosts.disconnected(first)
        second = bench.connect()
        bench.run(0.2)
        assert second.heard == b""
        bench.send(second, b"?")
        bench.run(0.2)
        assert second.heard == b"!"


async def test_a_host_in_the_network_gets_nothing_that_faults_have_held_back() -> None:
    bench = Bench("urg-04lx")
    bench.laser.faults = LinkFaults(delay=0.2)
    first = bench.connect()
    bench.send(first, b"?")
    bench.run(0.1)
    bench.laser.hosts.disconnected(first)
    second = bench.connect()
    bench.run(1.0)
    assert second.heard == b""


@pytest.mark.parametrize(("late", "heard"), [(0.04, b"?"), (0.06, b"")])
async def test_bytes_that_land_after_a_new_speed_are_understood_for_a_moment(
    monkeypatch: pytest.MonkeyPatch, late: float, heard: bytes
) -> None:
    clock, speed = [100.0], [19200]
    monkeypatch.setattr(laser_hosts, "_now", lambda: clock[0])
    bench = Bench("urg-04lx")
    assert isinstance(bench.laser.hosts, laser_hosts.OneHost)
    bench.laser.hosts.set_terminal(lambda: speed[0])
    bench.run(TICK)
    speed[0] = 9600
    clock[0] += 10.0  # the simulator is held up
    bench.run(TICK)
    clock[0] += late
    bench.run(TICK)
    clock[0] += 10.0  # again, before it reads
    bench.send(Host(permanent=True), b"?")
    bench.run(TICK)
    assert bench.device.connections[0].heard == heard


@pytest.mark.parametrize("name", ["ust-10lx", "utm-30lx"])
async def test_a_host_of_another_unit_has_a_connection_of_its_own(name: str) -> None:
    bench = Bench(name)
    assert bench.device.connections == []
    first = bench.connect()
    bench.send(first, b"S")
    bench.run(0.1)
    bench.laser.hosts.disconnected(first)
    assert bench.device.connections == []
    second = bench.connect()
    bench.run(0.1)
    assert second.heard == b""
    bench.send(second, b"?")
    bench.run(0.1)
    assert second.heard == b"!"


async def test_several_hosts_share_a_cola_unit() -> None:
    bench = Bench("lms-111")
    assert bench.laser.model.protocol is LaserProtocol.COLA
    hosts = [bench.connect() for _ in range(3)]
    for host in hosts[:2]:
        bench.send(host, b"S")
    bench.run(0.2)
    assert hosts[0].lines == hosts[1].lines
    assert len(hosts[0].lines) >= 9
    assert hosts[2].heard == b""
    bench.laser.hosts.disconnected(hosts[0])
    bench.run(TICK)
    assert len(bench.device.connections) == 2


async def test_a_unit_serves_only_so_many_hosts() -> None:
    bench = Bench("lms-111")
    hosts = [bench.connect() for _ in range(9)]
    assert [host.closed for host in hosts] == [False] * 8 + [True]


async def test_the_longest_silent_host_gives_way_to_one_too_many(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock = [100.0]
    monkeypatch.setattr(laser_hosts, "_now", lambda: clock[0])
    bench = Bench("lms-111")
    hosts = [bench.connect() for _ in range(8)]
    bench.send(hosts[0], b"S")  # it gets scans
    clock[0] += 1.0
    bench.send(hosts[1], b"?")
    clock[0] += 1.5
    bench.run(0.1)
    new = bench.connect()
    assert not new.closed
    assert [host.closed for host in hosts] == [False, False, True] + [False] * 5


async def test_a_flood_is_taken_in_small_pieces_and_loses_nothing() -> None:
    bench = Bench("lms-111")
    host = bench.connect()
    bench.send(host, b"?" * 4000)
    bench.run(TICK)
    assert 0 < len(host.heard) < 400
    bench.run(1.0)
    assert host.heard == b"!" * 4000


async def test_the_last_requests_of_a_host_are_obeyed_but_no_flood() -> None:
    for name in ("lms-111", "lms-200"):
        bench = Bench(name)
        host = bench.connect()
        bench.send(host, b"Q" * 4000)
        (connection,) = bench.device.connections
        bench.laser.hosts.disconnected(host)
        bench.run(1.0)
        assert connection.heard == b"Q" * 256


async def test_without_power_it_is_silent_and_begins_anew() -> None:
    bench = Bench("lms-200")
    host = bench.connect()
    bench.send(host, b"S")
    bench.run(0.2)
    bench.laser.switch_off()
    before = host.heard
    bench.send(host, b"?")
    bench.run(0.5)
    assert host.heard == before
    assert not host.closed  # a serial line does not tell
    bench.laser.switch_on()
    assert bench.device.switched_on == [-60.0, pytest.approx(0.7)]
    bench.run(0.2)
    assert host.heard == before  # it has forgotten that it was to stream
    bench.send(host, b"S")
    bench.run(0.2)
    later = Host()
    later.heard = host.heard[len(before) :]
    assert later.lines[0][0] == pytest.approx(0.9e6)


async def test_an_ethernet_unit_without_power_cuts_its_hosts_off() -> None:
    bench = Bench("lms-111")
    host = bench.connect()
    bench.laser.switch_off()
    assert host.closed
    assert bench.connect().closed
    bench.laser.switch_on()
    assert not bench.connect().closed


@pytest.mark.parametrize("name", ["utm-30lx", "ust-10lx", "lms-111"])
async def test_an_unplugged_cable_cuts_hosts_off(name: str) -> None:
    bench = Bench(name)
    host = bench.connect()
    bench.laser.unplug()
    bench.send(host, b"?")
    assert host.closed
    assert not bench.laser.connected
    assert bench.connect().closed
    bench.laser.plug_in()
    again = bench.connect()
    bench.send(again, b"?")
    bench.run(0.1)
    assert again.heard == b"!"


async def test_a_silent_laser_neither_hears_nor_is_heard() -> None:
    bench = Bench("utm-30lx")
    host = bench.connect()
    bench.send(host, b"S")
    bench.run(0.2)
    bench.laser.silence(0.5)
    before = host.heard
    bench.send(host, b"?")
    bench.run(0.48)
    assert host.heard == before
    bench.run(0.2)
    later = host.heard[len(before) :]
    assert later
    assert b"!" not in later
    assert int(later.split()[0]) >= 0.64e6  # the scans of the silence are lost


async def test_a_cable_has_faults() -> None:
    bench = Bench("utm-30lx")
    host = bench.connect()
    bench.laser.faults = LinkFaults(delay=0.1)
    bench.send(host, b"?")
    bench.run(0.18)
    assert host.heard == b""
    bench.run(0.1)
    assert host.heard == b"!"
    bench.laser.faults = LinkFaults(corrupt=1.0)
    bench.send(host, b"?")
    bench.run(0.1)
    assert host.heard == b"!"
    assert bench.device.connections[0].heard != b"??"


async def test_a_laser_rides_on_its_robot() -> None:
    bench = Bench("utm-30lx")
    host = bench.connect()
    bench.send(host, b"S")
    bench.run(0.1)
    bench.laser.body.robot_in_world = Pose2(1.0, 0.0)
    bench.run(0.1)
    assert {line[3] for line in host.lines} == {3000, 2000}
