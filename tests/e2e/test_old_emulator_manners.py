"""What the old emulator does wrongly (facts.md 9), our firmware does right. Virtual time."""

from itertools import pairwise
from math import degrees, radians
from random import Random

import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command, GyroMode, RequestMode, Tcm2Mode
from pioneer3.arcos.packet import PacketReader
from pioneer3.arcos.reports import Report, Sip
from pioneer3.geometry import wrap
from pioneer3.models import load_model
from pioneer3.sim.accessories import Equipment
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.world import World
from tests import combinations
from tests.e2e.plain_client import SYNCS
from tests.support import frame

ON = commands.Enable(on=True)
CYCLE, TICK = 0.1, 0.02


class Bench:
    """A robot alone in the plane whose host speaks and listens step by step."""

    def __init__(self, model: str = "p3at-sh", equipment: Equipment | None = None) -> None:
        self.body = Body(load_model(model))
        self.world = World(None, [self.body])
        self.firmware = Firmware(self.world, self.body, equipment=equipment)
        self.now = 0.0
        self._packets = PacketReader()
        self.firmware.receive(b"".join(SYNCS) + frame(commands.Open()) + frame(ON), self.now)
        self.wait(CYCLE)

    def say(self, *said: Command) -> None:
        """Send commands."""
        self.firmware.receive(b"".join(frame(command) for command in said), self.now)

    def wait(self, seconds: float, *, silent: bool = False) -> list[Report]:
        """Let time pass, with a PULSE each cycle unless `silent`; return what was reported."""
        heard: list[Report] = []
        for step in range(round(seconds / TICK)):
            if step % 5 == 0 and not silent:
                self.say(commands.Pulse())
            self.world.step(TICK)
            self.now += TICK
            self.firmware.tick(self.now)
            payloads = self._packets.feed(self.firmware.device.outgoing(), self.now)
            heard += [reports.from_payload(payload) for payload in payloads]
        return heard

    def speeds(self, seconds: float, *, silent: bool = False) -> list[float]:
        """Let time pass; return what the reports say of the speed [m/s]."""
        sips = [r for r in self.wait(seconds, silent=silent) if isinstance(r, Sip)]
        return [(sip.left_speed_raw + sip.right_speed_raw) / 2000 for sip in sips]


MODELS = ["p3at-sh", "p3at", "p3dx", "amigo-sh"]


@pytest.mark.parametrize(
    ("model", "heading", "distance_mm"),
    combinations.pairwise(MODELS, [0.0, 90.0, -120.0], [300, 500, 1000, -300, -500, -1000]),
)
def test_a_move_ends_at_its_distance(model: str, heading: float, distance_mm: int) -> None:
    # 9.3: backwards it grows faster and faster there; across the x axis it measures nothing
    bench = Bench(model)
    bench.say(commands.SetO(x=0.0, y=0.0, heading=radians(heading)))
    bench.say(commands.Move(distance_mm / 1000))
    bench.wait(12.0)
    here = bench.body.robot_in_world
    assert here.x * 1000 == pytest.approx(distance_mm, abs=20)
    assert here.y * 1000 == pytest.approx(0, abs=20)
    there = bench.body.robot_in_odom
    assert degrees(there.theta) == pytest.approx(heading, abs=0.5)
    assert bench.speeds(0.5) == [0.0] * 5


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("angle_deg", [45, 90, -45, -90])
def test_a_relative_turn_after_seto_ends_at_its_angle(model: str, angle_deg: int) -> None:
    bench = Bench(model)
    bench.say(commands.RVel(radians(-40)))
    bench.wait(3.0)
    bench.say(commands.RVel(0.0))
    bench.wait(1.0)
    before = bench.body.robot_in_world.theta
    bench.say(commands.SetO(), commands.DHead(radians(angle_deg)))
    bench.wait(6.0)
    turned = wrap(bench.body.robot_in_world.theta - before)
    assert degrees(turned) == pytest.approx(angle_deg, abs=1)
    assert degrees(bench.body.robot_in_odom.theta) == pytest.approx(angle_deg, abs=1)


def test_motion_shows_in_the_next_report() -> None:
    bench = Bench()  # 9.2, 9.4: there in the second or third
    bench.say(commands.Vel(0.3), commands.RVel(radians(20)))
    sip = next(report for report in bench.wait(CYCLE) if isinstance(report, Sip))
    assert sip.left_speed_raw != 0
    assert sip.turn_rate_decidegrees != 0


@pytest.mark.parametrize("speed", [0.3, -0.3])
def test_a_reversal_takes_the_time_that_its_ramps_take(speed: float) -> None:
    bench = Bench()
    bench.say(commands.SetA(0.3), commands.SetA(-0.3), commands.Vel(speed))
    bench.wait(2.0)
    bench.say(commands.Vel(-speed))
    steps = bench.speeds(2.0)
    changes = [abs(after - before) for before, after in pairwise(steps)]
    assert max(changes) <= 0.3 * CYCLE + 0.002
    assert steps[9] == pytest.approx(0, abs=0.002)
    assert steps[-1] == pytest.approx(-speed, abs=0.001)


def test_setv_limits_vel() -> None:
    bench = Bench()  # 9.3: there only the speed of MOVE
    bench.say(commands.SetV(0.2), commands.Vel(0.5))
    assert bench.speeds(3.0)[-1] == pytest.approx(0.2, abs=0.001)


def test_after_two_silent_seconds_the_robot_stops_and_goes_on_reporting() -> None:
    # 12, row 8; there only a warning in the log
    bench = Bench()
    bench.say(commands.SetA(-0.3), commands.Vel(0.3))
    said_at = bench.now
    fast, braking = bench.speeds(2.0, silent=True), bench.speeds(1.2, silent=True)
    assert fast[-1] == pytest.approx(0.3, abs=0.001)
    assert braking[-1] == 0
    reports_in_silence = len(fast) + len(braking)
    assert reports_in_silence == pytest.approx((bench.now - said_at) / CYCLE, abs=1)
    bench.say(commands.RequestConfig())
    told = next(report for report in bench.wait(CYCLE) if isinstance(report, reports.Config))
    assert told.watchdog_ms == 2000


FITTED = Equipment(gripper=True, compass=True, gyro_type=1)
REQUESTS: list[tuple[Command, type[Report]]] = [
    (commands.IoRequest(RequestMode.STREAM), reports.Io),
    (commands.RequestEncoders(RequestMode.STREAM), reports.Encoders),
    (commands.Gyro(GyroMode.ON), reports.GyroRates),
    (commands.GripperPacRequest(RequestMode.STREAM), reports.GripperState),
    (commands.Tcm2(Tcm2Mode.STREAM), reports.Compass),
]


@pytest.mark.parametrize(
    ("request_", "answer"), REQUESTS, ids=[answer.__name__ for _, answer in REQUESTS]
)
def test_what_the_old_emulator_ignores_is_answered(request_: Command, answer: type[Report]) -> None:
    bench = Bench(equipment=FITTED)
    assert not [report for report in bench.wait(1.0) if isinstance(report, answer)]
    bench.say(request_)
    heard = bench.wait(1.0)
    count = sum(isinstance(report, answer) for report in heard)
    assert count == pytest.approx(sum(isinstance(report, Sip) for report in heard), abs=1)


def test_an_output_that_is_on_stays_on_when_it_is_set_again() -> None:
    bench = Bench()  # 9.6: there the second time clears it
    for _ in range(2):
        bench.say(commands.DigOut(mask=0x05, values=0x05))
        sip = next(report for report in bench.wait(CYCLE) if isinstance(report, Sip))
        assert sip.digital_out is not None
        assert sip.digital_out & 0x05 == 0x05


@pytest.mark.parametrize("seed", range(50))
def test_after_an_empty_packet_the_next_ones_are_understood(seed: int) -> None:
    random = Random(seed)
    bench = Bench()
    bench.firmware.receive(b"\xfa\xfb\x00" + random.randbytes(random.randrange(300)), bench.now)
    bench.wait(0.5, silent=True)  # 1.6: a packet that does not go on is given up
    bench.say(commands.RequestConfig())
    assert [r for r in bench.wait(CYCLE) if isinstance(r, reports.Config)]


def test_a_packet_after_one_in_two_pieces_is_not_swallowed() -> None:
    bench = Bench()  # 1.6: there it is, when both come in one read
    asked = frame(commands.RequestConfig())
    for cut in range(1, len(asked)):
        bench.firmware.receive(asked[:cut], bench.now)
        bench.firmware.receive(asked[cut:] + asked, bench.now)
        assert sum(isinstance(report, reports.Config) for report in bench.wait(CYCLE)) == 2
