"""Every mode and key of the demo with a simulated robot, in virtual time, without a screen."""

import asyncio
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from math import degrees, inf, pi

import pytest

from pioneer3.acts import REQUEST, Blob, encode
from pioneer3.arcos import commands
from pioneer3.arcos.commands import (
    Command,
    Enable,
    Gripper,
    GripperAction,
    IoRequest,
    RequestMode,
    Tcm2,
    Tcm2Mode,
)
from pioneer3.behaviors.action import Action, Desire, Situation, Stack
from pioneer3.demo.columns import ColumnRow
from pioneer3.demo.mode import Context, DemoMode, Description
from pioneer3.demo.modes import MODES
from pioneer3.demo.program import Program
from pioneer3.errors import ConfigError, PortNotFoundError
from pioneer3.links import Link
from pioneer3.links.memory import MemoryLink, null_modem
from pioneer3.maps import LineMap
from pioneer3.navigation.connect import connect_async
from pioneer3.robot.devices import Acts, Presence
from pioneer3.sim.equipment import Equipment
from pioneer3.teleop.keyboard import PATIENCE
from tests.support import SimulatedRobot, frame, until, wall_at

EVERYTHING = Equipment(gripper=True, compass=True, gyro_type=1, camera="vcc4", camera_port=2)
LETTERS = "tuwlbspcdofimag"
KEYS = [
    *("up", "down", "left", "right", "space", "pageup", "pagedown", "enter", "backspace", "tab"),
    *"0123456789!@#$%^-+.,ejnqrvxyzEJNQRVXYZhH?/",
    "ctrl+r",
]
"""All that no mode is entered with, and that neither stops nor quits."""
CYCLE = 0.15
"""Time enough for one report [s]."""


@dataclass
class Listener:
    """A face that remembers what it was told."""

    said: list[str] = field(default_factory=list)
    helps: int = 0
    modes: int = 0

    def say(self, text: str) -> None:
        self.said.append(text)

    def show_help(self) -> None:
        self.helps += 1

    def show_mode(self) -> None:
        self.modes += 1


@dataclass
class Demo:
    """A running demo and the robot at its far end."""

    program: Program
    face: Listener
    sim: SimulatedRobot
    serving: asyncio.Task[None]

    async def press(self, *keys: str) -> None:
        """Press one key after the other, a report's time apart."""
        for key in keys:
            self.program.press(key)
            await asyncio.sleep(CYCLE)

    @property
    def row(self) -> ColumnRow:
        row = self.program.row()
        assert row is not None
        return row

    def cell(self, name: str) -> str:
        """Return the text of a column."""
        return next(cell.text for cell in self.row.cells if cell.name == name)

    def sent(self, command: Command) -> int:
        return self.sim.wires[-1].data.count(frame(command))

    @property
    def words(self) -> str:
        return "\n".join(self.face.said)


def added(name: str, make: Callable[[Context, Description], DemoMode]) -> Description:
    """Return one mode more, on `y`."""
    return Description(key="y", name=name, hint="one more", make=make)


@asynccontextmanager
async def demo(
    line_map: LineMap | None = None,
    *,
    equipment: Equipment | None = None,
    first: str = "t",
    patience: float = PATIENCE,
    acts: Acts | None = None,
    modes: Sequence[Description] = MODES,
) -> AsyncIterator[Demo]:
    face = Listener()
    async with (
        SimulatedRobot(line_map, equipment=equipment) as sim,
        connect_async(sim.open) as robot,
    ):
        program = Program(
            robot,
            face,
            first=first,
            patience=patience,
            acts=acts or Acts(nowhere),
            modes=modes,
        )
        serving = asyncio.ensure_future(program.run())
        await asyncio.sleep(0.5)
        try:
            yield Demo(program, face, sim, serving)
        finally:
            program.over.set()
            await serving


async def nowhere() -> Link:
    raise PortNotFoundError("nobody listens")


class TestTheRulesOfAllModes:
    async def test_the_keys_are_arias(self) -> None:
        async with demo() as the:
            assert "".join(the.program.modes) == LETTERS
            assert the.program.active.about.key == "t"

    @pytest.mark.parametrize("key", LETTERS)
    async def test_every_mode_is_entered_with_both_cases_and_says_what_it_needs(
        self, key: str
    ) -> None:
        async with demo(wall_at(3.0), equipment=EVERYTHING) as the:
            before = "b" if key != "b" else "s"
            for letter in (key, key.upper()):
                await the.press(before, letter)
                assert the.program.active.about.key == key
            await asyncio.sleep(3.5)  # whatever it asks for has come
            assert the.program.active.presence().reason
            assert "failed" not in the.words
            if key != "b":  # a P3-AT has no bumpers
                assert the.program.row() is not None or the.program.details()

    async def test_teleop_begins_with_the_motors_on_and_nothing_moves(self) -> None:
        async with demo() as the:
            await until(lambda: the.sim.powered)
            await asyncio.sleep(2)
            assert the.sim.speed == 0

    async def test_choosing_the_active_mode_does_nothing(self) -> None:
        async with demo() as the:
            await the.press(*["up"] * 8)
            await asyncio.sleep(1)
            shown = the.face.modes
            await the.press("t", "T")
            assert the.sim.speed > 0.1
            assert the.face.modes == shown

    async def test_another_mode_stops_the_robot(self) -> None:
        async with demo() as the:
            await the.press(*["up"] * 8)
            await asyncio.sleep(1)
            assert the.sim.speed > 0.1
            await the.press("s")
            await until(lambda: the.sim.speed == 0)

    @pytest.mark.parametrize("key", ["h", "H", "?", "/"])
    async def test_four_keys_show_the_help(self, key: str) -> None:
        async with demo() as the:
            await the.press(key)
            assert the.face.helps == 1
            assert "detailed status/error flags mode: 'f' or 'F'" in the.program.help()
            assert "current mode: teleop" in the.program.help()

    @pytest.mark.parametrize("key", ["escape", "ctrl+c", "ctrl+d"])
    async def test_leaving_stops_the_robot(self, key: str) -> None:
        async with demo() as the:
            await the.press(*["up"] * 10)
            await asyncio.sleep(1)
            await the.press(key)
            await the.serving
            await until(lambda: the.sim.speed == 0)

    @pytest.mark.parametrize("key", LETTERS)
    async def test_every_key_is_pressed_in_every_mode_and_nothing_fails(self, key: str) -> None:
        async with demo(wall_at(3.0), equipment=EVERYTHING, first=key) as the:
            for pressed in KEYS:
                await the.press(pressed)
            await asyncio.sleep(5)
            assert the.program.active.about.key == key
            assert "failed, the robot" not in the.words
            await the.press("b" if key != "b" else "s")
            await until(lambda: the.sim.speed == 0)

    async def test_a_key_that_means_nothing_does_nothing(self) -> None:
        async with demo() as the:
            await the.press("q", "ö", "f12", "tab", "")
            assert the.program.active.about.key == "t"
            assert the.face.said == []

    @pytest.mark.parametrize("key", ["k", "K"])
    async def test_the_emergency_stop_latches_until_ctrl_r(self, key: str) -> None:
        async with demo() as the:
            await the.press(*["up"] * 10)
            await asyncio.sleep(1)
            await the.press(key)
            await until(lambda: the.sim.speed == 0 and not the.sim.powered)
            assert "[ESTOP]" in the.row.line
            assert "[DISABLED]" in the.row.line
            await the.press(*["up"] * 10)
            await asyncio.sleep(1)
            assert the.sim.speed == 0
            assert "the emergency stop is latched" in the.words
            await the.press("ctrl+r")
            await asyncio.sleep(1)
            assert not the.sim.powered
            await the.press(*["up"] * 10)
            await until(lambda: the.sim.speed > 0.1)


class TestTeleop:
    async def test_a_set_speed_is_kept_and_changes_by_a_twentieth(self) -> None:
        async with demo() as the:
            await the.press(*["up"] * 4)
            await asyncio.sleep(5)
            top = the.program.robot.info.limits.max_speed
            assert the.sim.speed == pytest.approx(0.2 * top, abs=0.01)
            assert the.program.gauges()[0].text == "+20%"
            await the.press("down")
            await asyncio.sleep(3)
            assert the.sim.speed == pytest.approx(0.15 * top, abs=0.01)
            assert the.cell("transVel") == str(round(0.15 * top * 1000))
            await the.press("space")
            await until(lambda: the.sim.speed == 0)
            assert the.program.gauges()[0].share == 0

    @pytest.mark.parametrize(("key", "sign"), [("left", 1), ("right", -1)])
    async def test_an_arrow_to_the_side_turns_while_it_repeats(self, key: str, sign: int) -> None:
        async with demo() as the:
            await until(lambda: the.sim.powered)
            for _ in range(40):  # held for 1.2 s: 0.5 s to 50 degrees/s, then on at that
                the.program.press(key)
                await asyncio.sleep(0.03)
            await asyncio.sleep(2)
            turned = degrees(the.sim.body.robot_in_world.theta) * sign
            assert 30 < turned < 60, turned
            assert the.sim.body.speeds[1] == 0

    async def test_the_guarded_one_stops_before_a_wall(self) -> None:
        async with demo(wall_at(2.0)) as the:
            await the.press(*["up"] * 10)
            await asyncio.sleep(15)
            assert the.sim.speed == pytest.approx(0, abs=0.01)
            front = the.sim.body.robot_in_world.x + the.sim.body.model.length_front
            assert front < 2.0

    async def test_the_unguarded_one_warns(self) -> None:
        async with demo() as the:
            await the.press("u")
            assert any("NOTHING" in line for line in the.program.help())

    async def test_a_speed_without_a_hand_ends(self) -> None:
        async with demo(patience=10.0) as the:
            await the.press(*["up"] * 6)
            await asyncio.sleep(8)
            assert the.sim.speed > 0.1
            await asyncio.sleep(4)
            assert the.sim.speed == 0
            assert "no key for 10 s" in the.words
            await the.press("up")  # begins anew: 5 % is too little
            await asyncio.sleep(2)
            assert the.sim.speed == 0

    @pytest.mark.parametrize("patience", [inf, 10.1, 0.0])
    async def test_nobody_can_ask_for_more_patience(self, patience: float) -> None:
        with pytest.raises(ConfigError, match="at most 10 s"):
            async with demo(patience=patience):
                pass

    async def test_hands_that_are_gone_stop_what_they_set_and_nothing_else(self) -> None:
        async with demo() as the:
            await the.press(*["up"] * 8)
            await asyncio.sleep(1)
            the.program.let_go("the terminal lost the focus")
            await until(lambda: the.sim.speed == 0)
            await the.press("w")
            await until(lambda: the.sim.speed > 0.1)
            the.program.let_go("the terminal lost the focus")
            await asyncio.sleep(1)
            assert the.sim.speed > 0.1

    async def test_space_stops_in_modes_that_have_another_use_for_it_or_none(self) -> None:
        async with demo() as the:
            await the.press("w")
            await until(lambda: the.sim.speed > 0.1)
            await the.press("space")
            await until(lambda: the.sim.speed == 0)
            await asyncio.sleep(5)
            assert the.sim.speed == 0  # the mode is over, not halted
            await the.press("w")
            await until(lambda: the.sim.speed > 0.1)
            await the.press("d", *"11", "space", *"300", "enter")
            await until(lambda: the.sim.speed > 0.1)
            await the.press("space")
            await until(lambda: the.sim.speed == 0)
            row = the.program.row()
            assert row is not None
            assert row.line == ">  "

    async def test_e_brings_power_back_and_sideways_is_explained(self) -> None:
        async with demo() as the:
            await until(lambda: the.sim.powered)
            await the.press("k", "ctrl+r")
            await until(lambda: not the.sim.powered)
            await the.press("e")
            await until(lambda: the.sim.powered)
            await the.press("z", "x")
            assert "sideways" in the.words


class TestWander:
    async def test_it_drives_by_itself_until_another_mode(self) -> None:
        async with demo(wall_at(4.0), first="w") as the:
            await until(lambda: the.sim.speed > 0.35)
            assert [cell.name for cell in the.row.cells][-1] == "volts"
            await the.press("p")
            await until(lambda: the.sim.speed == 0)

    async def test_after_a_stop_choosing_it_again_starts_it_again(self) -> None:
        async with demo(first="w") as the:
            await until(lambda: the.sim.speed > 0.2)
            the.program.robot.stop()
            await until(lambda: the.sim.speed == 0)
            await the.press("w")
            await until(lambda: the.sim.speed > 0.2)


class TestPosition:
    async def test_it_drives_its_distance_both_ways(self) -> None:
        async with demo(first="p") as the:
            await the.press("up")
            await until(lambda: the.program.robot.arbiter.mode is None)
            assert the.sim.body.robot_in_world.x == pytest.approx(1.0, abs=0.02)
            await the.press("pageup", "down")
            await until(lambda: the.program.robot.arbiter.mode is None)
            assert the.sim.body.robot_in_world.x == pytest.approx(-0.5, abs=0.04)

    async def test_the_distance_is_never_below_half_a_metre(self) -> None:
        async with demo(first="p") as the:
            await the.press(*["pagedown"] * 5)
            assert list(the.program.details()) == ["drives 0.5 m"]

    @pytest.mark.parametrize(("key", "angle"), [("left", 90), ("right", -90)])
    async def test_it_turns_right_angles(self, key: str, angle: float) -> None:
        async with demo(first="p") as the:
            await the.press(key)
            await until(lambda: the.program.robot.arbiter.mode is None)
            assert degrees(the.sim.body.robot_in_world.theta) == pytest.approx(angle, abs=2)

    async def test_both_turns_while_it_drives_and_either_does_not(self) -> None:
        ends = []
        for keys in ((), ("x",)):
            async with demo(first="p") as the:
                await the.press(*keys, "up")
                await asyncio.sleep(1)
                await the.press("left")
                await until(lambda: the.program.robot.arbiter.mode is None)
                ends.append(the.sim.body.robot_in_world)
                assert the.cell("mode") == ("either" if keys else "both")
        both, either = ends
        assert both.y > 0.3  # it went on, to the left
        assert abs(either.y) < 0.05  # it stopped, and turned on the spot
        assert either.x < 0.7
        assert both.theta == pytest.approx(either.theta, abs=0.1) == pytest.approx(pi / 2, abs=0.1)

    async def test_space_stops_and_r_makes_this_place_the_origin(self) -> None:
        async with demo(first="p") as the:
            await the.press("up")
            await asyncio.sleep(1)
            await the.press("space")
            await until(lambda: the.sim.speed == 0)
            await asyncio.sleep(1)
            there = the.sim.body.robot_in_world.x
            assert 0.05 < there < 0.9
            await the.press("r")
            assert (the.cell("x"), the.cell("y"), the.cell("th")) == ("0", "0", "0.00")
            assert float(the.cell("raw").split(",")[0]) == pytest.approx(1000 * there, abs=2)

    async def test_the_gyro_is_shown_and_switched_where_there_is_one(self) -> None:
        async with demo(first="p", equipment=EVERYTHING) as the:
            await asyncio.sleep(3)
            assert the.cell("gyro") == "on"
            await the.press("z")
            assert the.cell("gyro") == "off"
            await the.press("z")
            assert the.cell("gyro") == "only"
            await the.press("z")
            assert the.cell("gyro") == "on"

    async def test_without_a_gyro_z_says_so(self) -> None:
        async with demo(first="p") as the:
            await the.press("z")
            assert "no gyro" in the.words
            assert "gyro" not in the.row.header


class TestDevices:
    async def test_the_gripper_obeys_its_keys(self) -> None:
        async with demo(first="g", equipment=EVERYTHING) as the:
            for key, action in (
                ("up", GripperAction.LIFT_UP),
                ("down", GripperAction.LIFT_DOWN),
                ("right", GripperAction.OPEN),
                ("left", GripperAction.CLOSE),
                ("space", GripperAction.HALT),
            ):
                before = the.sent(Gripper(action))
                await the.press(key)
                assert the.sent(Gripper(action)) == before + 1
            assert the.cell("Paddles") in {"open", "between", "closed"}

    async def test_the_exercise_ends_with_the_next_key(self) -> None:
        async with demo(first="g", equipment=EVERYTHING) as the:
            await the.press("e")
            assert "exercising" in the.program.details()
            await asyncio.sleep(20)
            assert the.sent(Gripper(GripperAction.CLOSE)) > 0
            await the.press("up")
            assert "exercising" not in the.program.details()
            assert the.sent(Gripper(GripperAction.HALT)) > 0

    async def test_leaving_the_gripper_ends_its_exercise(self) -> None:
        async with demo(first="g", equipment=EVERYTHING) as the:
            await the.press("e", "s")
            assert not the.program.robot.devices.gripper.exercising

    async def test_a_robot_without_a_gripper_says_how_one_knows(self) -> None:
        async with demo(first="g") as the:
            assert "CONFIG says HasGripper 0" in the.words
            assert the.program.row() is None
            await the.press("up")
            assert the.program.active.about.key == "g"

    async def test_the_camera_is_chosen_and_aimed(self) -> None:
        async with demo(first="c", equipment=EVERYTHING) as the:
            await the.press("2", "2")
            await asyncio.sleep(2)
            assert "answers" in the.words
            camera = the.program.robot.devices.camera("vcc4", 2)
            await the.press("left", "left", "up", "z")
            assert degrees(camera.aim.pan) == pytest.approx(10)
            assert degrees(camera.aim.tilt) == pytest.approx(3)
            assert camera.aim.zoom == pytest.approx(0.01)
            await the.press("right", "down", "x")
            assert degrees(camera.aim.pan) == pytest.approx(5)
            await the.press("space")
            assert (camera.aim.pan, camera.aim.tilt, camera.aim.zoom) == (0, 0, 0)
            await the.press("e")
            await asyncio.sleep(8)
            assert camera.aim.pan != 0
            await the.press("space")
            await asyncio.sleep(20)
            assert camera.aim.pan == 0

    async def test_a_camera_that_does_not_answer_is_chosen_again(self) -> None:
        async with demo(first="c", equipment=EVERYTHING) as the:
            await the.press("1", "1")
            await asyncio.sleep(10)
            assert "No answer" in the.words or "does not answer" in the.words
            await the.press("2", "2")
            await asyncio.sleep(2)
            assert the.program.active.presence().there

    @pytest.mark.parametrize("key", ["3", "4", "!", "@", "#", "$", "%", "^"])
    async def test_cameras_that_are_not_built_are_named(self, key: str) -> None:
        async with demo(first="c") as the:
            await the.press(key)
            assert len(the.face.said) == 1

    async def test_the_lines_are_asked_for_while_the_mode_is_active(self) -> None:
        async with demo(first="i") as the:
            assert "digin0" in the.row.header
            assert the.sent(IoRequest(RequestMode.STREAM)) == 1
            await the.press("s")
            assert the.sent(IoRequest(RequestMode.STOP)) == 1

    async def test_the_compass_is_asked_for_and_takes_its_keys(self) -> None:
        async with demo(first="m", equipment=EVERYTHING) as the:
            await asyncio.sleep(1)
            assert the.cell("cnt") in {"9", "10", "11"}
            for mode in Tcm2Mode:
                before = the.sent(Tcm2(mode))
                await the.press(str(int(mode)))
                assert the.sent(Tcm2(mode)) > before
            await the.press("s")
            assert the.sim.wires[-1].data.rfind(frame(Tcm2(Tcm2Mode.SIP_ONLY))) > (
                the.sim.wires[-1].data.rfind(frame(Tcm2(Tcm2Mode.STREAM)))
            )

    async def test_the_laser_shows_the_wall(self) -> None:
        async with demo(wall_at(2.0), first="l") as the:
            await asyncio.sleep(1)
            assert the.row.line.startswith("Close: 2000mm")
            await the.press("z")
            assert the.row.line.count("refl") == 2
            await the.press("7")
            assert "no laser 7" in the.words
            await the.press("l")
            await asyncio.sleep(1)
            assert the.row.line.count("refl") == 2

    async def test_the_sonars_are_chosen_in_groups(self) -> None:
        async with demo(wall_at(2.0), first="s") as the:
            await asyncio.sleep(1)
            assert len(the.row.cells) == 8
            await the.press("1")
            assert len(the.row.cells) == 16
            await the.press("3")
            assert the.row.cells[0].name == "8"
            await the.press("4")
            assert not the.row.cells
            assert "no sonars 16 to 23" in the.words

    async def test_config_is_asked_for_at_each_activation(self) -> None:
        async with demo(first="o") as the:
            await asyncio.sleep(1)
            assert any("p3at-sh" in line for line in the.program.details())
            assert any("ticks_per_mm" in line for line in the.program.details())
            before = the.sent(commands.RequestConfig())
            await the.press("o")
            assert the.sent(commands.RequestConfig()) == before + 1

    async def test_status_asks_the_safety_systems(self) -> None:
        async with demo(first="f") as the:
            await asyncio.sleep(5)
            assert any("only MTX robots" in line for line in the.program.details())
            assert the.cell("mot.enable") == "yes"


class TestCommand:
    async def test_what_is_typed_is_sent(self) -> None:
        async with demo(first="d") as the:
            await the.press("4", "3", "backspace", "0", "space", "2", "enter")
            assert the.sent(IoRequest(RequestMode.STREAM)) == 1
            assert the.row.line == "> "
            assert list(the.program.details()) == ["sent: command 40, integer 2"]

    async def test_a_minus_comes_only_after_a_space(self) -> None:
        async with demo(first="d") as the:
            await the.press("-", "2", "1", "-", "space", "-", "-", "5")
            assert the.row.line == "> 21 -5"

    async def test_what_is_no_command_is_refused_in_words(self) -> None:
        async with demo(first="d") as the:
            await the.press("2", "5", "6", "enter")
            assert "not sent: command 256" in the.words

    async def test_motion_past_the_limits_ends_without_a_key(self) -> None:
        async with demo(first="d", patience=5.0) as the:
            await until(lambda: the.sim.powered)
            await the.press("1", "1", "space", "2", "0", "0", "enter")
            await until(lambda: the.sim.speed > 0.15)
            await until(lambda: the.sim.speed == 0)
            assert "no key for 5 s" in the.words

    async def test_another_mode_ends_motion_too(self) -> None:
        async with demo(first="d") as the:
            await until(lambda: the.sim.powered)
            await the.press("1", "1", "space", "2", "0", "0", "enter")
            await until(lambda: the.sim.speed > 0.15)
            await the.press("s")
            await until(lambda: the.sim.speed == 0)

    async def test_nothing_is_sent_while_the_emergency_stop_is_latched(self) -> None:
        async with demo(first="d") as the:
            await the.press("k", "4", "space", "1", "enter")
            assert "emergency stop is latched" in the.words
            assert the.sim.wires[-1].data.rfind(frame(Enable(on=False))) > (
                the.sim.wires[-1].data.rfind(frame(Enable(on=True)))
            )


class Tracker:
    """An ACTS server at the far end of a cable in memory, that sees one blob."""

    def __init__(self, x: int | None = 120) -> None:
        self.x = x
        self._tasks: list[asyncio.Task[None]] = []

    async def open(self) -> Link:
        ours, theirs = null_modem()
        self._tasks.append(asyncio.ensure_future(self._serve(theirs)))
        return ours

    async def _serve(self, link: MemoryLink) -> None:
        while data := await link.read():
            assert data == REQUEST
            await asyncio.sleep(1 / 30)
            blobs = {}
            if self.x is not None:
                blob = Blob(
                    area=400, x=self.x, y=60, left=self.x - 10, right=self.x + 10, top=50, bottom=70
                )
                blobs[2] = [blob]
            await link.write(encode(blobs))


class TestActs:
    async def test_it_follows_its_channel(self) -> None:
        tracker = Tracker()
        async with demo(first="a", acts=Acts(tracker.open)) as the:
            assert the.row.line == (
                "Channel: 1  movement off  passively acquiring  no blob in sight"
            )
            await the.press("2", "x")
            assert the.row.line == "Channel: 2  movement off  actively acquiring  blob in sight"
            await asyncio.sleep(1)
            assert the.sim.speed == 0
            await the.press("z")
            await until(lambda: the.sim.speed > 0.1)
            assert "movement on" in the.row.line
            assert the.sim.body.speeds[1] < 0  # the blob is on the right
            await the.press("space")
            await until(lambda: the.sim.speed == 0)
            assert "movement off" in the.row.line


class TestTrouble:
    async def test_a_lost_link_is_told_and_what_drove_must_be_started_anew(self) -> None:
        async with demo(first="w") as the:
            await until(lambda: the.sim.speed > 0.2)
            await the.sim.unplug()
            await asyncio.sleep(1)
            assert "LOST" in the.words
            assert the.program.row() is None
            await the.press("up", "w", "s", "w", "p", "up", "w")  # nothing fails meanwhile
            assert "failed" not in the.words
            await the.press("s")
            the.sim.plugged = True
            await until(lambda: the.program.robot.snapshot)
            await asyncio.sleep(3)
            assert "CONNECTED" in the.words
            assert the.sim.speed == 0
            await the.press("w")
            await until(lambda: the.sim.speed > 0.2)

    @pytest.mark.parametrize("key", "tuwp")
    async def test_nothing_sets_off_by_itself_when_the_robot_comes_back(self, key: str) -> None:
        async with demo() as the:
            await the.press(key, *["up"] * 8)
            await until(lambda: the.sim.speed > 0.1)
            await the.sim.unplug()
            await asyncio.sleep(1)
            await the.press(*["up"] * 3)
            await until(lambda: the.sim.speed == 0)
            the.sim.plugged = True
            await until(lambda: the.program.robot.snapshot)
            await asyncio.sleep(3)
            assert the.sim.speed == 0

    @pytest.mark.parametrize("key", "imlg")
    async def test_devices_are_asked_again_when_the_robot_comes_back(self, key: str) -> None:
        async with demo(wall_at(3.0), first=key, equipment=EVERYTHING) as the:
            await asyncio.sleep(1)
            await the.sim.unplug()
            await asyncio.sleep(1)
            the.sim.plugged = True
            await until(lambda: the.program.robot.snapshot)
            await asyncio.sleep(3)
            before = the.program.robot.snapshot
            assert before is not None
            devices = the.program.robot.devices
            latest = {
                "i": devices.lines.latest,
                "m": devices.compass.latest,
                "l": devices.laser.latest,
                "g": devices.gripper.latest,
            }[key]
            assert latest is not None
            assert before.stamp - latest.stamp < 1

    async def test_a_stall_ends_the_speed_that_was_set(self) -> None:
        async with demo(wall_at(1.0), first="u") as the:
            await the.press(*["up"] * 8)
            await until(lambda: "ended" in the.words, within=60)
            assert "stalled" in the.words
            await asyncio.sleep(2)
            assert the.sim.speed == 0

    async def test_a_mode_that_fails_stops_the_robot_and_the_demo_goes_on(self) -> None:
        def broken(context: Context, about: Description) -> DemoMode:
            def fail(key: str) -> bool:
                raise ZeroDivisionError("by hand")

            return DemoMode(about, on_key=fail)

        async with demo(first="w", modes=(*MODES, added("broken", broken))) as the:
            await until(lambda: the.sim.speed > 0.2)
            await the.press("y")
            await the.press("up")
            assert "broken failed, the robot is stopped: ZeroDivisionError: by hand" in the.words
            await the.press("w")
            await until(lambda: the.sim.speed > 0.2)

    async def test_a_presence_that_fails_is_no_reason_to_end(self) -> None:
        def fail() -> Presence:
            raise ZeroDivisionError("in the presence")

        def broken(context: Context, about: Description) -> DemoMode:
            return DemoMode(about, presence=fail)

        async with demo(modes=(*MODES, added("broken", broken))) as the:
            assert "in the presence" in the.program.modes["y"].presence().reason

    async def test_columns_that_fail_are_told_once(self) -> None:
        def fail() -> ColumnRow:
            raise ZeroDivisionError("in the columns")

        def broken(context: Context, about: Description) -> DemoMode:
            return DemoMode(about, row=fail)

        async with demo(modes=(*MODES, added("broken", broken))) as the:
            await the.press("y")
            for _ in range(10):
                assert the.program.row() is None
            assert the.words.count("in the columns") == 1

    async def test_an_action_that_fails_stops_the_robot_and_is_named(self) -> None:
        class Bad(Action):
            name = "bad idea"

            def decide(self, situation: Situation) -> Desire:
                if situation.twist.v > 0.2:
                    raise ZeroDivisionError("in an action")
                return Desire(v=0.5)

        def user(context: Context, about: Description) -> DemoMode:
            def on_key(key: str) -> bool:
                context.start(Stack.alone(Bad(), 20))
                return True

            return DemoMode(about, on_key=on_key)

        async with demo(modes=(*MODES, added("user", user))) as the:
            await the.press("y", "up")
            await until(lambda: "bad idea" in the.words)
            await until(lambda: the.sim.speed == 0)
            await the.press("w")
            await until(lambda: the.sim.speed > 0.2)
