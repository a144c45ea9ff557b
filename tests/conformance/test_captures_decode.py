"""Sessions of real ARIA programs against AMRISim: nothing in them may be unknown."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.packet import HEADER, checksum

CAPTURES = sorted((Path(__file__).parents[3] / "shared" / "captures").glob("*.txt"))
OLD_LASER_NUMBERS = range(35, 39)  # ARIA sets up simulated lasers with these

pytestmark = pytest.mark.skipif(not CAPTURES, reason="no captures beside this checkout")


def payloads(capture: Path, direction: str) -> Iterator[bytes]:
    """Yield the payload of each frame that went in `direction`."""
    for line in capture.read_text().splitlines():
        match line.split():
            case [_, way, _, data] if way == direction:
                yield from frames(bytes.fromhex(data))


def frames(data: bytes) -> Iterator[bytes]:
    """Yield the payloads of the frames that `data` consists of."""
    while data:
        frame, data = data[: data[2] + 3], data[data[2] + 3 :]
        assert frame.startswith(HEADER)
        assert int.from_bytes(frame[-2:], "big") == checksum(frame[3:-2])
        yield frame[3:-2]


@pytest.mark.parametrize("capture", CAPTURES, ids=lambda path: path.stem)
def test_every_report_is_known_and_encodes_to_the_same_bytes(capture: Path) -> None:
    for payload in payloads(capture, "S>C"):
        report = reports.from_payload(payload)
        assert not isinstance(report, reports.UnknownReport), payload.hex(" ")
        assert reports.to_payload(report) == payload


@pytest.mark.parametrize("capture", CAPTURES, ids=lambda path: path.stem)
def test_every_command_is_known_and_encodes_to_the_same_bytes(capture: Path) -> None:
    shaking_hands = 3
    for index, payload in enumerate(payloads(capture, "C>S")):
        command = commands.from_payload(payload, simulator=payload[0] in OLD_LASER_NUMBERS)
        assert not isinstance(command, commands.Unknown), payload.hex(" ")
        if index >= shaking_hands:  # SYNC1 and SYNC2 read as OPEN and CLOSE without argument
            assert commands.to_payload(command) == payload
