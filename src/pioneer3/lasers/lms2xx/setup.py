"""The set-up of an LMS-2xx: from an unknown state to scans, as a script that waits for answers.

::

    search ──any telegram──► idle ──► speed ──► type ──► variant ──► configuration ──► stream
       ▲                       └── no answer, or a doubtful one: search again ──┘

Rules:

1. A unit that streams is heard at any speed, if only as noise. Then the request to stop is tried at
   each speed for as long as a telegram takes, twice that if one has begun; on a silent line the
   request for the type, for as long as an answer takes.
2. The answer to a mode does not say which one, and may come late. So no mode is asked for before
   the last one is answered, or 3 s are over; and then the status is asked for: answers come in
   order, so with it none is outstanding.
3. The configuration is written only if the unit measures otherwise than wanted: its EEPROM wears
   out. Everything else in it stays.

Facts: lms2xx.md 1.3, 1.5 to 1.8, 2.2.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import degrees, radians
from typing import Final, TypeVar

from pioneer3.lasers.client import (
    Identified,
    LaserIdentity,
    LineSpeedWanted,
    Patience,
    Remarked,
    ScanSettings,
)
from pioneer3.lasers.dialogue import HopelessError, Pause, Script
from pioneer3.lasers.line import duration
from pioneer3.lasers.lms2xx import commands
from pioneer3.lasers.lms2xx.blocks import UnitConfig, UnitStatus
from pioneer3.lasers.lms2xx.commands import ANSWER, CommandCode, OperatingMode, Unasked
from pioneer3.lasers.lms2xx.measuring import MEASURING_MODES, VARIANTS, Units, Variant
from pioneer3.lasers.lms2xx.scans import VALUES
from pioneer3.lasers.lms2xx.telegram import Telegram, encode

LISTEN: Final = 0.06
"""Longest pause of a unit that streams [s]: four turns."""
SETTLE: Final = 0.05
"""Pause after a change of speed [s]."""
MODE_LIMIT: Final = 3.0
"""Time that the answer to a mode may take [s] (lms2xx.md 1.3)."""
WRITE_LIMIT: Final = 14.0
"""Time that writing the EEPROM may take [s], twice what the maker says (lms2xx.md 1.3)."""
ACKNOWLEDGE: Final = 0.1
"""Time after a telegram in which a unit that streams obeys [s]."""
LONGEST: Final = 814
"""Bytes of the longest telegram."""
TRIES: Final = 3
WITHOUT_INTENSITIES: Final = (0x05, 0x06)
"""Measuring modes that reach 32 m; the first is that of ARIA (lms2xx.md 2.1)."""
WITH_INTENSITIES: Final = (0x03,)
"""Four levels to 16 m: eight would leave 8 m, two do not deserve the name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wait:
    """A step of the script: send a request, unless it is empty, and wait for an answer.

    It is sent `tries` times, with `limit` for each answer [s]. Telegrams with one of `codes`
    answer, or any if they are `None`; with `ends_with_noise` any byte ends the step, without an
    answer.
    """

    limit: float
    request: bytes = b""
    codes: frozenset[int] | None = None
    tries: int = 1
    ends_with_noise: bool = False


T = TypeVar("T")
LmsScript = Script[Wait, Telegram | None, T]


def wanted_variant(settings: ScanSettings) -> Variant:
    """Return the variant that comes nearest to `settings`; without a step, 1 degree.

    The line carries twice as many scans of 1 degree as of half a degree.
    """
    first, last, edge = settings.first, settings.last, radians(50)
    narrow = first is not None and last is not None and -edge <= first <= last <= edge
    step_cdeg = 100.0 if settings.step is None else 100 * degrees(settings.step)
    fields = [v for v in VARIANTS if v.field_deg == (100 if narrow else 180)]
    return min(fields, key=lambda v: abs(v.step_cdeg - step_cdeg))


class SetUp:
    """The script, and its findings.

    It tries `speeds` [baud] in their order, none where the link has none, and goes to `target`. An
    answer may come `round_trip` later than over a cable [s]. The caller sets `now` and `has_begun`,
    whether a telegram is coming, before each step, and `heard` whenever a byte comes. `speed` is
    the link's, `line_speed` the unit's, which is known on links without a speed, too [baud].
    """

    def __init__(
        self,
        now: float,
        *,
        speeds: Sequence[int],
        target: int | None,
        settings: ScanSettings,
        patience: Patience,
        round_trip: float,
    ) -> None:
        self.now = now
        self.speed: int | None = None
        self.heard = self.has_begun = False
        self.line_speed: int | None = None
        self.variant = self._wanted = wanted_variant(settings)
        self.measuring_mode = MEASURING_MODES[WITHOUT_INTENSITIES[0]]
        self._speeds: list[int | None] = [*speeds] if speeds else [None]
        self._target = target
        self._settings = settings
        self._answer_limit = patience.answer + round_trip
        self._round_trip = round_trip
        self._give_up_at = now + patience.give_up
        self._ever_heard = False

    def script(self) -> LmsScript[None]:
        """Return the script, which ends once the unit scans; HopelessError if it does not."""
        while (found := (yield from self._search())) is not None:
            if (yield from self._prepare(found)):
                return
            if self.now >= self._give_up_at:
                raise HopelessError("it answers, but does not begin to scan")
        raise HopelessError(self._reason_for_silence())

    def _reason_for_silence(self) -> str:
        if self._ever_heard:
            return "something sends, but not as an LMS-2xx does"
        speeds = sorted(speed for speed in self._speeds if speed is not None)
        at = f" at {', '.join(map(str, speeds))} baud" if speeds else ""
        return f"nothing answers{at}; a laser that has just been switched on takes up to a minute"

    def _set_speed(self, speed: int | None) -> LmsScript[None]:
        if speed is not None and speed != self.speed:
            yield LineSpeedWanted(speed)
        self.speed = speed

    def _search(self) -> LmsScript[Telegram | None]:
        """Return any telegram of the unit, at whatever speed; `None` when time is up."""
        while True:
            for speed in [*self._speeds]:
                if self.now >= self._give_up_at:
                    return None
                yield from self._set_speed(speed)
                self.heard = False
                found = yield Wait(limit=LISTEN + self._round_trip, ends_with_noise=True)
                if found is None and self.heard:
                    self._ever_heard = True
                    limit = duration(LONGEST, speed) + ACKNOWLEDGE + self._round_trip
                    found = yield Wait(request=commands.mode(OperatingMode.ON_REQUEST), limit=limit)
                    if found is None and self.has_begun:
                        found = yield Wait(limit=limit)
                elif found is None:
                    found = yield self._ask(CommandCode.TYPE, tries=1, any_telegram=True)
                if found is not None:
                    self._prefer(speed)
                    return found

    def _prefer(self, speed: int | None) -> None:
        """Begin the next search with `speed`."""
        self._speeds.sort(key=lambda other: other != speed)

    def _ask(
        self,
        command: CommandCode,
        data: bytes = b"",
        *,
        tries: int = TRIES,
        limit: float | None = None,
        any_telegram: bool = False,
    ) -> Wait:
        """Return the step that asks `command`; REFUSED is an answer too."""
        transfer = duration(LONGEST if command is CommandCode.STATUS else 64, self.speed)
        return Wait(
            request=encode(command, data),
            limit=(self._answer_limit if limit is None else limit + self._round_trip) + transfer,
            codes=None if any_telegram else frozenset({command + ANSWER, Unasked.REFUSED}),
            tries=tries,
        )

    def _ask_mode(
        self, mode: OperatingMode, data: bytes = b"", *, scans_answer: bool = False
    ) -> Wait:
        """Return the step that asks for a mode, once (rule 2)."""
        step = self._ask(CommandCode.MODE, bytes((mode,)) + data, tries=1, limit=MODE_LIMIT)
        assert step.codes is not None
        return replace(step, codes=step.codes | {VALUES}) if scans_answer else step

    def _prepare(self, found: Telegram) -> LmsScript[bool]:
        """Return whether the unit, heard at the present speed, has been made to scan."""
        status = yield from self._stop(found)
        if status is None or not (yield from self._change_speed()):
            return False
        text = yield self._ask(CommandCode.TYPE)
        if text is None:
            return False
        self.line_speed = self.speed or status.speed
        yield Identified(_identity(text, status))
        if status.defective:
            yield Remarked("the laser reports that it is defective")
        set_up = (yield from self._set_variant(status)) and (yield from self._configure(status))
        if not set_up:
            return False
        answer = yield self._ask_mode(OperatingMode.ALL_VALUES, scans_answer=True)
        return answer is not None and (answer.code == VALUES or _is_mode_taken(answer))

    def _stop(self, found: Telegram) -> LmsScript[UnitStatus | None]:
        """Make the unit idle, with no answer outstanding; return its status."""
        stopped = found.code == CommandCode.MODE + ANSWER
        for _ in range(TRIES):
            if not stopped:
                yield self._ask_mode(OperatingMode.ON_REQUEST)
            answer = yield self._ask(CommandCode.STATUS, limit=MODE_LIMIT, tries=2)
            status = _block(UnitStatus.from_bytes, answer)
            if status is None:
                return None
            if status.mode not in commands.STREAMS:
                return status
            stopped = False
        return None

    def _change_speed(self) -> LmsScript[bool]:
        """Go to the target speed; return whether the unit answers there."""
        if self.speed is None or self._target is None or self.speed == self._target:
            return True
        before, target = self.speed, self._target
        answer = yield self._ask_mode(commands.MODE_OF_SPEED[target])
        if answer is None:
            return False
        if not _is_mode_taken(answer):
            yield Remarked(f"the laser refuses {target} baud and stays at {before}")
            self._target = before
            return True
        yield from self._set_speed(target)
        yield Pause(SETTLE)
        if (yield self._ask(CommandCode.TYPE)) is not None:
            self._prefer(target)
            return True
        yield Remarked(f"the laser does not answer at {target} baud; back to {before}")
        self._target = before
        return False

    def _set_variant(self, status: UnitStatus) -> LmsScript[bool]:
        """Set field and step, where they differ; return whether the unit answers."""
        self.variant = status.variant
        if self.variant == self._wanted:
            return True
        answer = yield self._ask(CommandCode.VARIANT, commands.variant_data(self._wanted))
        if answer is not None and _is_taken(answer):
            self.variant = self._wanted
        elif answer is not None:
            told = f"the laser refuses {self._wanted} and goes on with {self.variant}"
            yield Remarked(told)
        return answer is not None

    def _configure(self, status: UnitStatus) -> LmsScript[bool]:
        """Set measuring mode and units, where they differ; return whether the unit can scan."""
        numbers = WITH_INTENSITIES if self._settings.intensities else WITHOUT_INTENSITIES
        if status.measuring_mode not in numbers or status.units != Units.MILLIMETRES:
            answer = yield self._ask(CommandCode.CONFIG)
            if answer is None:
                return False
            config = _block(UnitConfig.from_bytes, answer)
            if config is None:
                yield Remarked("the laser does not tell its configuration")
            else:
                wanted = replace(config, measuring_mode=numbers[0], units=Units.MILLIMETRES)
                written = yield from self._write(wanted.to_bytes(len(answer.body)))
                if written is None:
                    return False
                if written:
                    yield Remarked(_change(config, wanted))
                    status = replace(status, measuring_mode=numbers[0])
                else:
                    yield Remarked("the laser refuses to be configured")
        mode = MEASURING_MODES.get(status.measuring_mode)
        if mode is None or mode.amplitude:
            yield Remarked(f"the laser's measuring mode {status.measuring_mode} has no ranges")
            return False
        self.measuring_mode = mode
        return True

    def _write(self, block: bytes) -> LmsScript[bool | None]:
        """Write the configuration; return whether it is taken, or `None` without an answer."""
        opened = yield self._ask_mode(OperatingMode.INSTALLATION, commands.PASSWORD)
        if opened is None or not _is_mode_taken(opened):
            return None if opened is None else False
        answer = yield self._ask(CommandCode.CONFIGURE, block, tries=1, limit=WRITE_LIMIT)
        return None if answer is None else _is_taken(answer)


def _is_taken(answer: Telegram) -> bool:
    return answer.code != Unasked.REFUSED and answer.data[0] == commands.ACCEPTED


def _is_mode_taken(answer: Telegram) -> bool:
    return answer.code != Unasked.REFUSED and answer.data[0] == commands.MODE_ACCEPTED


def _change(before: UnitConfig, after: UnitConfig) -> str:
    """Return the text that tells what has been written."""
    return (
        f"the laser's EEPROM now has measuring mode {after.measuring_mode} in millimetres; it had "
        f"mode {before.measuring_mode} in {Units(before.units).name.lower()}"
    )


def _block(read: Callable[[bytes], T], answer: Telegram | None) -> T | None:
    try:
        return None if answer is None else read(answer.body)
    except ValueError:
        return None


def _identity(text: Telegram, status: UnitStatus) -> LaserIdentity:
    """Return the identity in the answer to TYPE, such as `LMS200;301061;V02.30`."""
    letters = "" if text.code == Unasked.REFUSED else text.body.decode("ascii", "replace")
    product, _, firmware = letters.rpartition(";")
    return LaserIdentity(
        vendor="SICK",
        product="-".join(part.strip() for part in product.split(";") if part.strip()),
        firmware=firmware.strip() or status.version.decode("ascii", "replace").strip(),
        protocol="LMS-2xx telegrams",
        status="defective" if status.defective else "no defect",
    )
