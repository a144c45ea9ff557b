"""One host at a simulated laser: requests and answers. No I/O.

Rules:

1. Each answer is one piece of :meth:`Connection.outgoing`, and leaves before any later scan: some
   programs read an answer with one call, and accept nothing between request and answer.
2. sEN 0 takes back the scans that have not left yet: its answer is the last that comes.
3. Scans wait for a slow host only so long: of those that have not left, the latest stay.
4. Logins are kept per connection; settings, and the mirror, belong to the laser.

Facts: cola.md 1.4, 1.5, 2, 6.2.
"""

from collections.abc import Callable, Mapping
from typing import Final, Protocol

from pioneer3.lasers.cola.configuration import (
    PASSWORDS,
    AccessMode,
    DataConfig,
    Error,
    OutputRange,
    ScanConfig,
)
from pioneer3.lasers.cola.scan import NAME
from pioneer3.lasers.cola.unit import ColaUnit, RefusedError
from pioneer3.lasers.cola.wire import (
    U16,
    ColaTelegramReader,
    TelegramError,
    TelegramWords,
    encode,
    hex_word,
)

MOST_WAITING: Final = 2
"""Scans that wait to leave."""
MOST_POLLS: Final = 8
"""Requests for one scan that wait for it; the unit is too busy for more."""


class Owner(Protocol):
    """The device as its connections know it."""

    def tick(self, now: float) -> None:
        """Act on the passing of time."""

    def plan(self, now: float) -> None:
        """Take note that the output of a connection has changed."""

    def forget(self, connection: "ColaConnection") -> None:
        """Drop a connection that has been closed."""

    def switch_on(self, now: float) -> None:
        """Begin as after a power cycle."""


class ColaConnection:
    """One host, until it closes or the laser loses its power.

    It gets every scan if it is `subscribed`, and one for each of `polling` requests that wait.
    """

    def __init__(self, unit: ColaUnit, owner: Owner) -> None:
        self.subscribed = False
        self.polling = 0
        self.reader = ColaTelegramReader()
        self._unit, self._owner = unit, owner
        self._access = AccessMode.RUN
        self._dead = False
        self._answers: list[bytes] = []
        self._scans: list[bytes] = []

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes of the host, in any pieces."""
        if self._dead:
            return
        self._owner.tick(now)
        for text in self.reader.feed(data):
            if self._dead:  # a request before this one was to reboot
                break
            self._flush_scans()
            answer = self._answer(text.split(" "), now)
            if answer:
                self._answers.append(encode(answer))
        self._owner.plan(now)

    def outgoing(self, now: float) -> bytes:
        """Return and forget the bytes that may leave by `now`: whole telegrams, all there are."""
        self._flush_scans()
        data = b"".join(self._answers)
        self._answers.clear()
        self._owner.plan(now)
        return data

    def close(self) -> None:
        """Take the end of the network connection: its subscription ends, the mirror goes on."""
        self.cut()
        self._answers.clear()
        self._owner.forget(self)

    @property
    def has_output(self) -> bool:
        """Whether there are bytes to send."""
        return bool(self._answers or self._scans)

    def cut(self) -> None:
        """Hear nothing any more: the laser has lost its power."""
        self._dead, self.subscribed, self.polling = True, False, 0
        self._scans.clear()

    def send_scan(self, words: str) -> None:
        """Send a scan to a host that wants it."""
        for _ in range(self.polling):
            self._answers.append(encode(f"sRA {NAME} {words}"))
        self.polling = 0
        if self.subscribed:
            self._scans.append(encode(f"sSN {NAME} {words}"))
            del self._scans[:-MOST_WAITING]

    def _flush_scans(self) -> None:
        """Put the scans that wait behind the answers so far."""
        self._answers += self._scans
        self._scans.clear()

    def _answer(self, words: list[str], now: float) -> str:
        """Return the answer to one request, empty for one that is answered later."""
        kind, rest = words[0], TelegramWords(words[1:])
        try:
            if kind == "sRI0":
                return f"sRA 0 {self._unit.ident}"
            if kind in HANDLERS:
                return HANDLERS[kind](self, rest, now)
            return _refusal(Error.UNKNOWN_REQUEST)
        except RefusedError as refused:
            return _refusal(refused.number)
        except TelegramError:
            return _refusal(Error.INVALID_CHARACTER)

    def _read(self, words: TelegramWords, now: float) -> str:
        name = words.word()
        if name == NAME:
            latest = self._unit.latest_scan(now)
            if latest is None:
                if self.polling >= MOST_POLLS:
                    raise RefusedError(Error.SERVER_BUSY)
                self.polling += 1
                return ""
            return f"sRA {NAME} {latest}"
        variable = self._unit.variables(now).get(name)
        if variable is None:
            raise RefusedError(Error.UNKNOWN_VARIABLE)
        return f"sRA {name} {variable}"

    def _write(self, words: TelegramWords, now: float) -> str:
        name = words.word()
        write = WRITES.get(name)
        if write is None:
            raise RefusedError(Error.UNKNOWN_VARIABLE)
        if self._access < AccessMode.AUTHORISED:
            raise RefusedError(Error.WRITE_ACCESS_DENIED)
        write(self._unit, words)
        return f"sWA {name}"

    def _subscribe(self, words: TelegramWords, now: float) -> str:
        if words.word() != NAME:
            raise RefusedError(Error.UNKNOWN_EVENT)
        self.subscribed = words.flag()
        words.end()
        if not self.subscribed:
            unwanted = f"sSN {NAME} ".encode()
            self._answers = [a for a in self._answers if not a.startswith(unwanted, 1)]
        return f"sEA {NAME} {self.subscribed:d}"

    def _call(self, words: TelegramWords, now: float) -> str:
        name = words.word()
        method = METHODS.get(name)
        if method is None:
            raise RefusedError(Error.UNKNOWN_METHOD)
        if name not in OPEN_METHODS and self._access < AccessMode.AUTHORISED:
            raise RefusedError(Error.METHOD_ACCESS_DENIED)
        answer = method(self, words, now)
        return f"sAN {name} {answer}".rstrip()

    def _set_access(self, words: TelegramWords, now: float) -> str:
        level, password = words.number(), words.number()
        words.end()
        accepted = PASSWORDS.get(level) == password
        if accepted:
            self._access = AccessMode(level)
        return f"{accepted:d}"

    def _run(self, words: TelegramWords, now: float) -> str:
        words.end()
        self._access = AccessMode.RUN
        self._unit.measure(on=True)
        return "1"

    def _set_scan(self, words: TelegramWords, now: float) -> str:
        code = self._unit.set_scan(ScanConfig.parse(words))
        return f"{code:X} {self._unit.settings.scan.answer()}"

    def _set_date(self, words: TelegramWords, now: float) -> str:
        numbers = [words.number(U16) for _ in range(6)]
        micros = words.number(999_999)
        words.end()
        return f"{self._unit.set_date(numbers, micros, now):d}"


def _write_echo_filter(unit: ColaUnit, words: TelegramWords) -> None:
    echo_filter = words.number()
    words.end()
    unit.set_echo_filter(echo_filter)


Handler = Callable[[ColaConnection, TelegramWords, float], str]


def _without_words(act: Callable[[ColaConnection, float], None], answer: str) -> Handler:
    """Return the handler of a method that has no words."""

    def handle(connection: ColaConnection, words: TelegramWords, now: float) -> str:
        words.end()
        act(connection, now)
        return answer

    return handle


HANDLERS: Final[Mapping[str, Handler]] = {
    "sRN": ColaConnection._read,
    "sWN": ColaConnection._write,
    "sMN": ColaConnection._call,
    "sEN": ColaConnection._subscribe,
}
WRITES: Final[Mapping[str, Callable[[ColaUnit, TelegramWords], None]]] = {
    "LMPoutputRange": lambda unit, words: unit.set_output(OutputRange.parse(words)),
    "LMDscandatacfg": lambda unit, words: unit.set_data(DataConfig.parse(words)),
    "FREchoFilter": _write_echo_filter,
}
METHODS: Final[Mapping[str, Handler]] = {
    "SetAccessMode": ColaConnection._set_access,
    "Run": ColaConnection._run,
    "mLMPsetscancfg": ColaConnection._set_scan,
    "mEEwriteall": _without_words(lambda host, now: host._unit.store(), "1"),
    "LMCstartmeas": _without_words(lambda host, now: host._unit.measure(on=True), "0"),
    "LMCstopmeas": _without_words(lambda host, now: host._unit.measure(on=False), "0"),
    "LSPsetdatetime": ColaConnection._set_date,
    "mSCreboot": _without_words(lambda host, now: host._owner.switch_on(now), ""),
}
OPEN_METHODS: Final = frozenset({"SetAccessMode", "Run"})
"""Methods that need no login."""


def _refusal(number: Error) -> str:
    return f"sFA {hex_word(number)}"
