"""The simulated robot takes whatever a host may say and lives on within its limits."""

from hypothesis import given, settings
from hypothesis import strategies as st

from pioneer3.arcos import commands, reports
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.world import World
from tests.combinations import examples
from tests.property.test_codecs import messages
from tests.support import frame

COMMANDS = [cls for cls in commands.every_command() if cls is not commands.Close]


@settings(max_examples=examples(150))
@given(st.lists(st.sampled_from(COMMANDS).flatmap(messages), max_size=6))
def test_any_commands_leave_a_robot_that_reports(said: list[commands.Command]) -> None:
    body = Body(load_model("p3at-sh"))
    world = World(None, [body])
    firmware = Firmware(world, body)
    for sync in (0, 1, 2, 1):
        firmware.receive(encode(bytes([sync])), 0.0)
    firmware.receive(frame(commands.Enable(on=True)), 0.0)
    now = 0.0
    for command in said:
        firmware.receive(frame(command), now)
        firmware.device.outgoing()
        for _ in range(6):
            now += 0.02
            world.step(0.02)
            firmware.tick(now)
            assert abs(body.drive.linear.velocity) <= body.model.max_speed + 1e-9
            assert abs(body.drive.angular.velocity) <= body.model.max_turn_rate + 1e-9
        sent = [reports.from_payload(p) for p in PacketReader().feed(firmware.device.outgoing())]
        assert sum(isinstance(report, reports.Sip) for report in sent) >= 1
