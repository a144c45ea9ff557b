"""Faults of the cable between a host and its robot, on demand and repeatable."""

from collections import deque
from collections.abc import Iterator
from difflib import get_close_matches
from math import inf, isfinite
from random import Random
from typing import Self

from pioneer3.arcos.packet import HEADER
from pioneer3.errors import ConfigError

SHARES = ("drop", "corrupt")
NUMBERS = (*SHARES, "delay", "seed")
SWITCHES = ("frozen", "unplugged")
FORM = "such as drop=0.01,corrupt=0.001,delay=0.2"


class LinkFaults:
    """Faults of one robot's cable, in both directions; may be changed at any time.

    Time is simulated and the random numbers are seeded, so the same bytes at the same ticks have
    the same faults.

    While it is `frozen` nothing passes either way and all that is sent is lost, as out of a radio's
    range; the connection stays. `unplugged`: no host is connected, and new ones are turned away.
    """

    def __init__(
        self, *, drop: float = 0.0, corrupt: float = 0.0, delay: float = 0.0, seed: int = 0
    ) -> None:
        self.drop, self.corrupt, self.delay = drop, corrupt, delay
        self.seed = seed
        self.frozen = False
        self.unplugged = False

    @classmethod
    def parse(cls, text: str, *, seed: int = 0) -> Self:
        """Return the faults in a text; without a seed of its own they have `seed`.

        The text has any of `drop=SHARE`, `corrupt=SHARE`, `delay=SECONDS`, `seed=NUMBER`, `frozen`
        and `unplugged`, separated by commas; empty for a good cable.

        Raises:
            ConfigError: it names the word that is wrong.
        """
        faults = cls(seed=seed)
        for word in filter(None, (word.strip() for word in text.split(","))):
            faults._set(word)
        return faults

    @property
    def drop(self) -> float:
        """Share of the packets that are lost; bytes outside packets are lost by the tick."""
        return self._drop

    @drop.setter
    def drop(self, share: float) -> None:
        self._drop = _share("drop", share)

    @property
    def corrupt(self) -> float:
        """Share of the bytes that arrive changed."""
        return self._corrupt

    @corrupt.setter
    def corrupt(self, share: float) -> None:
        self._corrupt = _share("corrupt", share)

    @property
    def delay(self) -> float:
        """How long bytes travel each way [s]."""
        return self._delay

    @delay.setter
    def delay(self, delay: float) -> None:
        if not (isfinite(delay) and delay >= 0):
            raise ConfigError(f"delay: {delay:g} is not a time from 0 s")
        self._delay = delay

    def unplug(self) -> None:
        """Pull the cable out: the host is disconnected, and new ones are turned away."""
        self.unplugged = True

    def plug_in(self) -> None:
        """Let hosts connect again."""
        self.unplugged = False

    @property
    def any(self) -> bool:
        """Whether there is any fault."""
        return bool(self._drop or self._corrupt or self._delay or self.frozen)

    def __str__(self) -> str:
        """Return the text that :meth:`parse` reads, "none" for a good cable."""
        values = (("drop", self.drop), ("corrupt", self.corrupt), ("delay", self.delay))
        words = [f"{name}={value!r}".removesuffix(".0") for name, value in values if value]
        words += [name for name in SWITCHES if getattr(self, name)]
        return ",".join([*words, *([f"seed={self.seed}"] if words and self.seed else [])]) or "none"

    def _set(self, word: str) -> None:
        name, equals, text = (part.strip() for part in word.partition("="))
        if name in SWITCHES and not equals:
            self.frozen |= name == "frozen"
            self.unplugged |= name == "unplugged"
        elif name in NUMBERS and equals:
            setattr(self, name, _number(name, text))
        elif name in NUMBERS:
            raise ConfigError(f"link faults: {name} needs a value, {FORM}")
        elif name in SWITCHES:
            raise ConfigError(f"link faults: {name} takes no value")
        elif word != "none":
            near = get_close_matches(name, (*NUMBERS, *SWITCHES), n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"write them {FORM}"
            raise ConfigError(f"link faults: {name!r} is none; {hint}")


class CableDirection:
    """One direction of a cable, which delays, loses and changes bytes as its faults say."""

    def __init__(self, faults: LinkFaults, direction: str) -> None:
        self._faults = faults
        self._random = Random(f"{faults.seed} {direction}")
        self._travelling: deque[tuple[float, bytes]] = deque()

    @property
    def due(self) -> float:
        """When the next bytes arrive [s]; `inf` while none are on their way."""
        return self._travelling[0][0] if self._travelling else inf

    def transmit(self, data: bytes, now: float) -> bytes:
        """Send `data` at `now` [s]; return the bytes that arrive now."""
        faults, travelling = self._faults, self._travelling
        if faults.frozen:
            self.clear()
            return b""
        spoiled = self._spoil(data) if faults.drop or faults.corrupt else data
        if not (faults.delay or travelling):
            return spoiled
        if spoiled:
            travelling.append((max(now + faults.delay, self._last), spoiled))
        arrived = bytearray()
        while travelling and travelling[0][0] <= now + 1e-6:
            arrived += travelling.popleft()[1]
        return bytes(arrived)

    def clear(self) -> None:
        """Drop the bytes that are on their way."""
        self._travelling.clear()

    @property
    def _last(self) -> float:
        """Before this nothing arrives: bytes do not overtake each other."""
        return self._travelling[-1][0] if self._travelling else -inf

    def _spoil(self, data: bytes) -> bytes:
        random, kept = self._random.random, bytearray()
        for frame in _frames(data):
            if random() >= self._faults.drop:
                kept += frame
        if self._faults.corrupt:
            for place in range(len(kept)):
                if random() < self._faults.corrupt:
                    kept[place] ^= self._random.randrange(1, 256)
        return bytes(kept)


def _frames(data: bytes) -> Iterator[bytes]:
    """Yield the packets in `data`; the bytes between two packets are one piece."""
    start = 0
    while start < len(data):
        if data.startswith(HEADER, start) and start + 2 < len(data):
            end = start + 3 + data[start + 2]
        else:
            found = data.find(HEADER, start + 1)
            end = found if found >= 0 else len(data)
        yield data[start:end]
        start = end


def _share(name: str, share: float) -> float:
    if not 0 <= share <= 1:
        raise ConfigError(f"{name}: {share:g} is not a share from 0 to 1")
    return share


def _number(name: str, text: str) -> float:
    try:
        return int(text) if name == "seed" else float(text)
    except ValueError:
        raise ConfigError(f"{name}: {text!r} is not a number") from None
