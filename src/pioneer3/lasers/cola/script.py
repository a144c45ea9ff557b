"""The host's requests up to the first scan, in order: a script that waits for each answer.

:func:`set_up` yields a :class:`TelegramRequest` or a :class:`Pause`, and is resumed with the
answer. The client that runs it repeats requests that are not answered.

Facts: cola.md 2, 6.1.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import ceil, degrees, floor
from typing import Final, TypeVar

from pioneer3.lasers.client import Identified, LaserIdentity, Remarked, ScanSettings
from pioneer3.lasers.cola.configuration import (
    ERRORS,
    PASSWORDS,
    AccessMode,
    DataConfig,
    Measuring,
    OutputRange,
    ScanConfig,
    ScanConfigCode,
)
from pioneer3.lasers.cola.families import FRONT_TICK, Family, exact_step, family_of, limits_of
from pioneer3.lasers.cola.scan import NAME
from pioneer3.lasers.cola.wire import TelegramError, TelegramWords, hex_word
from pioneer3.lasers.dialogue import HopelessError, Pause, Script

_ALMOST: Final = 1e-3
"""Angles that differ by less than this many steps are the same."""


def wished_scan(present: ScanConfig, wishes: ScanSettings, family: Family) -> ScanConfig:
    """Return the wished frequency, step and area; `present` as far as it fulfils them."""
    if not family.adjustable:
        return present
    step, frequency = present.step_tick, present.frequency_chz
    if wishes.step is not None:
        wanted = degrees(wishes.step) * 1e4
        step = min(family.steps_tick, key=lambda own: abs(exact_step(own) - wanted))
    if step in family.steps_tick and not family.fits(frequency, step):
        frequency = max(f for f in family.frequencies_chz if family.fits(f, step))
    output = wished_output(replace(present, step_tick=step), wishes, family)
    first, last = present.first_tick, present.last_tick
    if output.first_tick < first or output.last_tick > last:
        first, last = family.first_tick, family.last_tick
    return replace(
        present, frequency_chz=frequency, step_tick=step, first_tick=first, last_tick=last
    )


def wished_output(scan: ScanConfig, wishes: ScanSettings, family: Family) -> OutputRange:
    """Return the part of the scan to send: whole steps from the begin of the laser's field."""
    step, first, last = exact_step(scan.step_tick), family.first_tick, family.last_tick
    steps = floor((last - first) / step + _ALMOST)
    begin, end = 0, steps
    if wishes.first is not None:
        begin = floor((_tick(wishes.first) - first) / step + _ALMOST)
    if wishes.last is not None:
        end = ceil((_tick(wishes.last) - first) / step - _ALMOST)
    begin = min(max(begin, 0), steps - 1)
    end = min(max(end, begin + 1), steps)
    return OutputRange(
        step_tick=scan.step_tick,
        first_tick=first + round(begin * step),
        last_tick=first + round(end * step),
    )


def wished_data(present: DataConfig, wishes: ScanSettings, family: Family) -> DataConfig:
    """Return the wished content of scans; all else stays as in `present`."""
    return replace(
        present,
        echoes=(1 << family.echoes) - 1 if wishes.multi_echo else 1,
        remission=wishes.intensities,
        interval=wishes.skip + 1,
    )


def _tick(angle: float) -> float:
    return degrees(angle) * 1e4 + FRONT_TICK


T = TypeVar("T")
MIRROR_PATIENCE: Final = 60.0
"""Longest that a laser may take from power-on to its first scan [s]."""
POLL: Final = 0.5
"""Between two questions whether it measures [s]."""
SLOW: Final = 5.0
"""Methods that change the mirror's speed may take this long [s]."""
MOST_MISREAD: Final = 3
"""Answers to one request that cannot be read before the client goes on without."""
ANSWERS: Final = {"sRN": "sRA", "sRI": "sRA", "sWN": "sWA", "sMN": "sAN", "sEN": "sEA"}
CODES: Final[Mapping[int, str]] = {
    ScanConfigCode.FREQUENCY: "it does not have this scan frequency",
    ScanConfigCode.STEP: "it does not have this step at this scan frequency",
    ScanConfigCode.FREQUENCY_AND_STEP: "it has neither this scan frequency nor this step",
    ScanConfigCode.AREA: "this part is outside its field",
}
STATES: Final[Mapping[int, str]] = {
    Measuring.INITIALISING: "it is starting",
    Measuring.CONFIGURING: "it is being configured",
    Measuring.IDLE: "it is idle",
    Measuring.ROTATED: "its mirror is getting up to speed",
    Measuring.PREPARING: "it is preparing",
    Measuring.READY: "it is ready, but stopped",
}


@dataclass(frozen=True, slots=True)
class TelegramRequest:
    """A telegram to send, and the first two words of its answer.

    It is not repeated before `patience` [s].
    """

    text: str
    answer: tuple[str, str]
    patience: float = 0.0


@dataclass(frozen=True, slots=True)
class ErrorAnswer:
    """The answer sFA with its number, 0 where there is none."""

    number: int

    def __str__(self) -> str:
        """Return the reason for people."""
        return ERRORS.get(self.number, f"error {self.number:X}")


ColaScript = Script[TelegramRequest, TelegramWords | ErrorAnswer, T]


@dataclass(slots=True)
class ScriptState:
    """The state that the script shares with the client that runs it.

    `family` is `None` as long as it is not known; `limits` are the shortest and the longest range
    [m]; every `interval`-th scan is sent.
    """

    wishes: ScanSettings
    now: float
    family: Family | None = None
    limits: tuple[float, float] = (0.0, 0.0)
    interval: int = 1


def set_up(session: ScriptState) -> ColaScript[None]:
    """Bring the laser to send scans; HopelessError if it cannot be."""
    yield from _ask(f"sEN {NAME} 0", TelegramWords.rest)
    product = yield from _identify()
    session.family, session.limits = family_of(product), limits_of(product)
    if session.family is not None:
        yield from _configure(session, session.family)
    yield from _await_mirror(session)
    for _ in range(MOST_MISREAD):  # a late answer to the first request is of the same kind
        if (yield from _ask(f"sEN {NAME} 1", TelegramWords.number)) == 1:
            return
    raise HopelessError("the laser refuses to send scans: end other programs that use it")


def _ask(
    text: str, parse: Callable[[TelegramWords], T], *, patience: float = 0.0
) -> ColaScript[T | ErrorAnswer]:
    """Send `text` and return its answer as `parse` reads it; a refusal where it cannot be read."""
    kind, _, rest = text.partition(" ")
    name = rest.partition(" ")[0]
    if kind.startswith("sRI"):  # by index: the index is in the first word, without a space
        kind, name = kind[:3], kind[3:]
    request = TelegramRequest(text, (ANSWERS[kind], name), patience)
    for _ in range(MOST_MISREAD):
        reply = yield request
        if isinstance(reply, ErrorAnswer):
            return reply
        try:
            return parse(reply)
        except TelegramError as error:
            misread = str(error)
    yield Remarked(f"the laser's answer to `{text}` cannot be read: {misread}")
    return ErrorAnswer(0)


def _identify() -> ColaScript[str]:
    """Ask for the laser's names and numbers; return the product."""
    identity = yield from _ask("sRI0", _two_texts)
    if isinstance(identity, ErrorAnswer):
        identity = yield from _ask("sRN DeviceIdent", _two_texts)
    serial = yield from _ask("sRN SerialNumber", _text)
    firmware = yield from _ask("sRN FirmwareVersion", _text)
    product, version = ("", "") if isinstance(identity, ErrorAnswer) else identity
    yield Identified(
        LaserIdentity(
            vendor="SICK",
            product=product,
            serial="" if isinstance(serial, ErrorAnswer) else serial,
            firmware=version if isinstance(firmware, ErrorAnswer) else firmware,
            protocol="CoLa-A",
        )
    )
    return product


def _configure(session: ScriptState, family: Family) -> ColaScript[None]:
    """Read the settings, and write those that are not as wished."""
    wishes = session.wishes
    scan = yield from _ask("sRN LMPscancfg", ScanConfig.parse)
    output = yield from _ask("sRN LMPoutputRange", OutputRange.parse)
    data = yield from _read_data(session)
    changes: list[str] = []
    if not isinstance(scan, ErrorAnswer):
        wanted = wished_scan(scan, wishes, family)
        if wanted != scan:
            changes.append(f"sMN mLMPsetscancfg {wanted.request()}")
        if not isinstance(output, ErrorAnswer):
            part = wished_output(wanted, wishes, family)
            if (part.first_tick, part.last_tick) != (output.first_tick, output.last_tick):
                changes.append(f"sWN LMPoutputRange {part.words()}")
    if not isinstance(data, ErrorAnswer):
        content = wished_data(data, wishes, family)
        if content != data:
            changes.append(f"sWN LMDscandatacfg {content.request()}")
    if wishes.multi_echo and family.echo_filter:
        present = yield from _ask("sRN FREchoFilter", TelegramWords.number)
        if present != 1:
            changes.append("sWN FREchoFilter 1")
    if changes:
        yield from _change(changes)
        if not isinstance(data, ErrorAnswer):
            yield from _read_data(session)


def _change(changes: list[str]) -> ColaScript[None]:
    """Log in, carry out `changes`, log out."""
    if not (yield from _log_in()):
        return
    for change in changes:
        name = change.split(" ")[1]
        by_method = name == "mLMPsetscancfg"
        parse = TelegramWords.number if by_method else _nothing
        code = yield from _ask(change, parse, patience=SLOW if by_method else 0.0)
        if code != ScanConfigCode.OK:
            reason = code if isinstance(code, ErrorAnswer) else CODES.get(code, f"code {code}")
            yield Remarked(f"the laser keeps its {name} as it is: {reason}")
    yield from _run()


def _read_data(session: ScriptState) -> ColaScript[DataConfig | ErrorAnswer]:
    data = yield from _ask("sRN LMDscandatacfg", DataConfig.parse)
    if not isinstance(data, ErrorAnswer):
        session.interval = max(data.interval, 1)
    return data


def _log_in() -> ColaScript[bool]:
    level = AccessMode.AUTHORISED
    login = f"sMN SetAccessMode {level:02X} {hex_word(PASSWORDS[level])}"
    accepted = yield from _ask(login, _success)
    if accepted is True:
        return True
    yield Remarked("the laser refuses the login, so its settings stay: was its password changed?")
    return False


def _run() -> ColaScript[None]:
    """Log out and measure; some lasers answer 0, and measure all the same (cola.md 6.3)."""
    answer = yield from _ask("sMN Run", TelegramWords.rest, patience=SLOW)
    if isinstance(answer, ErrorAnswer):
        yield Remarked(f"the laser refuses to run: {answer}")


def _await_mirror(session: ScriptState) -> ColaScript[None]:
    """Wait until the laser measures; start one that has been stopped."""
    began = session.now
    stopped = started = 0
    while True:
        trouble = yield from _trouble(session.family)
        if not trouble:
            return
        yield Remarked(f"no scans yet: {trouble}")
        if session.now >= began + MIRROR_PATIENCE:
            raise HopelessError(
                f"the laser does not measure {MIRROR_PATIENCE:g} s after its first answer:"
                f" {trouble}; check its supply, and switch it off and on"
            )
        stopped = stopped + 1 if trouble in {STATES[Measuring.READY], STATES[Measuring.IDLE]} else 0
        if stopped > 1 and not started:
            started = 1
            if (yield from _log_in()):
                yield from _ask("sMN LMCstartmeas", TelegramWords.rest, patience=SLOW)
                yield from _run()
        yield Pause(POLL)


def _trouble(family: Family | None) -> ColaScript[str]:
    """Return the reason why the laser does not measure, empty if it does or does not tell."""
    first = family.state_request if family else "STlms"
    for variable in (first, "SCdevicestate" if first == "STlms" else "STlms"):
        state = yield from _ask(f"sRN {variable}", TelegramWords.number)
        if isinstance(state, ErrorAnswer):
            continue
        if variable == "STlms":
            if state == Measuring.MEASURING:
                return ""
            return STATES.get(state, f"state {state}")
        return {0: "it is busy", 1: ""}.get(state, "it reports an error")
    return ""


def _success(words: TelegramWords) -> bool:
    """Return whether a method was carried out; some lasers do not tell (cola.md 6.3)."""
    success = words.flag() if len(words) else True
    words.end()
    return success


def _nothing(words: TelegramWords) -> int:
    """Take the answer to a written variable, which has no words."""
    words.end()
    return ScanConfigCode.OK


def _text(words: TelegramWords) -> str:
    """Return a text with its length before it, or as it stands where that does not fit."""
    everything = words.rest()
    again = TelegramWords(everything.split(" "))
    try:
        text = again.text()
        again.end()
    except TelegramError:
        return everything.strip()
    return text.strip()


def _two_texts(words: TelegramWords) -> tuple[str, str]:
    """Return the product and the version of its program."""
    product = words.text().strip()
    return product, _text(words)
