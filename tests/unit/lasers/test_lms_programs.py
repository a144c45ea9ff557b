"""What ARIA, sicktoolbox and Player send to an LMS-2xx, with their own time limits, and what
becomes of it, as with the programs themselves (lms2xx.md 2.1, 2.2)."""

from collections.abc import Callable, Collection
from dataclasses import dataclass

import pytest

from pioneer3.lasers.lms2xx import LmsDevice, commands
from pioneer3.lasers.lms2xx.commands import CommandCode, OperatingMode
from pioneer3.lasers.lms2xx.scans import Measurement
from pioneer3.lasers.lms2xx.telegram import UNITS, LmsTelegramReader, Telegram, encode
from tests.unit.lasers.lms_support import LMS200, STEP, Cable

STOP, STREAM = commands.mode(OperatingMode.ON_REQUEST), commands.mode(OperatingMode.ALL_VALUES)
TO_38400, TO_9600 = (
    commands.mode(OperatingMode.SPEED_38400),
    commands.mode(OperatingMode.SPEED_9600),
)
INSTALL = commands.mode(OperatingMode.INSTALLATION, commands.PASSWORD)
ARIAS_CONFIG = bytes.fromhex("0200210077 0000460000050100000202" + "00" * 21 + "5B51")
VARIANT_1 = bytes.fromhex("020005003BB40064009749")
VARIANT_HALF = bytes.fromhex("020005003BB40032003B1F")
B0, B1, B2, B7, BA, BB, A0, F4, F7 = 0xB0, 0xB1, 0xB2, 0xB7, 0xBA, 0xBB, 0xA0, 0xF4, 0xF7


class Failed(Exception):  # noqa: N818
    """The program gives up."""


@dataclass
class Host:
    """A program at the cable that reads telegrams of some addresses."""

    cable: Cable
    addresses: Collection[int]

    def __post_init__(self) -> None:
        self.flush()

    def flush(self) -> None:
        """Forget what has been received."""
        self._reader = LmsTelegramReader(self.addresses)
        self._waiting: list[Telegram] = []

    def send(self, data: bytes) -> None:
        self.cable.send(data)

    def pause(self, seconds: float) -> None:
        """Do something else."""
        for _ in range(round(seconds / STEP)):
            self._read()

    def next(self, seconds: float) -> Telegram | None:
        """Return the next telegram, if one comes in time."""
        end = self.cable.now + seconds
        while not self._waiting and self.cable.now < end:
            self._read()
        return self._waiting.pop(0) if self._waiting else None

    def wait_for(self, code: int, seconds: float, body: bytes = b"") -> Telegram:
        """Return the next telegram with a code, and a body that begins so."""
        end = self.cable.now + seconds
        while (telegram := self.next(end - self.cable.now)) is not None:
            if telegram.code == code and telegram.body.startswith(body):
                return telegram
        raise Failed(f"0x{code:02X}")

    def ask(self, data: bytes, code: int, seconds: float, tries: int, body: bytes = b"") -> bytes:
        """Send and wait, a few times; return the body of the answer."""
        for _ in range(tries):
            self.flush()
            self.send(data)
            try:
                return self.wait_for(code, seconds, body).body
            except Failed:
                continue
        raise Failed(f"0x{code:02X}")

    def _read(self) -> None:
        items = self._reader.feed(self.cable.step(), self.cable.now)
        self._waiting += [item for item in items if isinstance(item, Telegram)]


def aria(cable: Cable, *, power_control: bool = False, start_speed: int = 9600) -> None:
    """Connect and read scans as ArLMS2xx does."""
    cable.speed = start_speed
    host = Host(cable, UNITS)
    if power_control:
        host.send(encode(CommandCode.RESET))
        host.wait_for(0x90, 65.0)
    host.send(TO_38400)
    host.pause(0.02)
    cable.speed = 38400
    host.pause(0.3)
    host.send(VARIANT_1)
    end = cable.now + 10.0
    while (answer := host.next(end - cable.now)) is None or answer.body[:1] != b"\x01":
        if answer is None:
            raise Failed("variant")
        if answer.code == B0:
            host.send(STOP)
            host.pause(0.2)
            host.send(VARIANT_1)
    for request, code, body, limit in (
        (INSTALL, A0, b"\x00", 10.0),
        (ARIAS_CONFIG, F7, b"", 14.0),
        (STREAM, A0, b"\x00", 1.0),
    ):
        host.pause(0.2)
        host.send(request)
        host.wait_for(code, limit, body)
    for _ in range(5):
        scan = host.wait_for(B0, 8.0)
        assert len(Measurement.from_body(scan.code, scan.body).values) == 181
    host.send(STOP)
    host.pause(1.0)
    host.send(TO_9600)
    host.pause(0.1)


def sicktoolbox(cable: Cable) -> None:
    """Connect and read scans as SickLMS2xx does, without 500000 baud."""
    cable.speed = 9600
    host = Host(cable, {0x80})
    try:
        host.ask(TO_38400, A0, 1.0, 3, b"\x00")
        cable.speed = 38400
    except Failed:
        for speed in (19200, 38400):
            cable.speed = speed
            try:
                host.ask(encode(CommandCode.ERRORS), B2, 3.0, 1)
                break
            except Failed:
                continue
        else:
            raise
        if speed != 38400:
            host.ask(TO_38400, A0, 1.0, 3, b"\x00")
            cable.speed = 38400
    host.pause(0.25)
    host.ask(STOP, A0, 3.0, 3, b"\x00")
    assert host.ask(encode(CommandCode.TYPE), BA, 1.0, 3).startswith(b"LMS200;30106")
    assert len(host.ask(encode(CommandCode.STATUS), B1, 1.0, 3)) == 152
    assert len(host.ask(encode(CommandCode.CONFIG), F4, 1.0, 3)) == 34
    host.ask(STREAM, A0, 3.0, 3, b"\x00")
    for _ in range(5):
        host.flush()
        scan = host.wait_for(B0, 1.0)
        count = len(Measurement.from_body(scan.code, scan.body).values)
        assert count == cable.device.unit.variant.count  # it keeps the unit's variant
    host.ask(STOP, A0, 3.0, 3, b"\x00")
    host.ask(TO_9600, A0, 1.0, 3, b"\x00")


def player(cable: Cable, *, step: bytes = VARIANT_HALF) -> None:
    """Connect and read scans as sicklms200 does, without 500000 baud."""
    host = Host(cable, {0x80})

    def exchange(request: bytes, code: int, seconds: float) -> bytes:
        """Take the next telegram that is no scan for the answer, whatever it is."""
        host.send(request)
        end = cable.now + seconds
        while (telegram := host.next(end - cable.now)) is not None:
            if telegram.code not in {B0, B7}:
                if telegram.code != code:
                    raise Failed(f"0x{telegram.code:02X} for 0x{code:02X}")
                return telegram.body
        raise Failed("nothing")

    for speed in (9600, 38400):
        cable.speed = speed
        try:
            host.ask(STOP, A0, 1.0, 3)
            break
        except Failed:
            continue
    else:
        raise Failed("no rate")
    host.pause(1.0)
    if speed != 38400:
        host.flush()
        exchange(TO_38400, A0, 0.25)
        cable.speed = 38400
        host.pause(1.0)
    assert exchange(encode(CommandCode.TYPE), BA, 1.0)[:3] == b"LMS"
    try:
        exchange(INSTALL, A0, 0.25)
    except Failed:
        exchange(INSTALL, A0, 0.25)
    status = b"\xb1" + exchange(encode(CommandCode.STATUS), B1, 1.0)
    if status[107:111] != step[5:9]:
        assert exchange(step, BB, 1.0)[:1] == b"\x01"
    config = exchange(encode(CommandCode.CONFIG), F4, 1.0)
    wanted = config[:4] + b"\x00\x01\x01"
    if config[:7] != wanted:
        assert exchange(encode(CommandCode.CONFIGURE, wanted), F7, 10.0)[:1] == b"\x01"
    part = commands.mode(OperatingMode.SUBRANGE, bytes.fromhex("0100b500"))
    exchange(part if step == VARIANT_1 else STREAM, A0, 0.25)
    code, count = (B7, 181) if step == VARIANT_1 else (B0, 361)
    for _ in range(5):
        scan = host.wait_for(code, 1.0)
        assert len(Measurement.from_body(scan.code, scan.body).values) == count


def unit(speed: int = 9600, *, streams: bool = False, **options: object) -> Cable:
    cable = Cable(LmsDevice(LMS200, start_speed=speed, **options), speed)  # type: ignore[arg-type]
    if streams:
        cable.send(STREAM)
        cable.listen(2.34)
    return cable


def aria_with_power_control(cable: Cable) -> None:
    aria(cable, power_control=True)


def player_at_one_degree(cable: Cable) -> None:
    player(cable, step=VARIANT_1)


PROGRAMS = [aria, sicktoolbox, player, player_at_one_degree]


@pytest.mark.parametrize("program", [*PROGRAMS, aria_with_power_control])
@pytest.mark.parametrize("streams", [False, True])
def test_at_9600_every_program_connects(program: Callable[[Cable], None], streams: bool) -> None:
    cable = unit(streams=streams, boot=5.0)
    began = cable.now
    program(cable)
    assert cable.now - began < 20


@pytest.mark.parametrize("program", PROGRAMS)
@pytest.mark.parametrize("streams", [False, True])
def test_at_38400_every_program_connects_without_power_control(
    program: Callable[[Cable], None], streams: bool
) -> None:
    program(unit(38400, streams=streams))


@pytest.mark.parametrize("program", PROGRAMS)
def test_one_program_after_the_other_connects(program: Callable[[Cable], None]) -> None:
    cable = unit()
    for each in (program, *PROGRAMS):
        each(cable)


@pytest.mark.parametrize("streams", [False, True])
def test_a_reset_at_the_wrong_speed_is_not_heard(streams: bool) -> None:
    with pytest.raises(Failed, match="0x90"):
        aria(unit(38400, streams=streams), power_control=True)


def test_at_19200_only_sicktoolbox_connects() -> None:
    sicktoolbox(unit(19200))
    aria(unit(19200), start_speed=19200)
    with pytest.raises(Failed, match="variant"):
        aria(unit(19200))
    with pytest.raises(Failed, match="no rate"):
        player(unit(19200))


def test_address_81_is_for_aria_only() -> None:
    aria(unit(address=0x81))
    for program in (sicktoolbox, player):
        with pytest.raises(Failed):
            program(unit(address=0x81))


def test_a_late_answer_misleads_player_only() -> None:
    late = {CommandCode.MODE: 0.3}
    aria(unit(delays=late))
    sicktoolbox(unit(delays=late))
    with pytest.raises(Failed):
        player(unit(38400, delays=late))


def test_a_very_late_answer_is_too_late_for_aria() -> None:
    for speed in (9600, 38400):
        with pytest.raises(Failed):
            aria(unit(speed, delays={CommandCode.MODE: 1.5}))
    sicktoolbox(unit(38400, delays={CommandCode.MODE: 0.9}))


def test_each_connect_of_aria_writes_the_eeprom() -> None:
    cable = unit()
    aria(cable)
    aria(cable)
    assert cable.device.unit.config_writes == 2
    assert (cable.device.unit.config.measuring_mode, cable.device.unit.config.units) == (5, 1)


def test_player_writes_the_eeprom_once() -> None:
    cable = unit()
    player(cable)
    player(cable)
    assert cable.device.unit.config_writes == 1
    assert cable.device.unit.mode is OperatingMode.ALL_VALUES  # it leaves the stream on
