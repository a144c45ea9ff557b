"""Finding and reading gamepads, with a kernel that answers as linux/input.h says."""

import asyncio
import errno
import fcntl
import os
import struct
from dataclasses import dataclass
from pathlib import Path

import pytest

from pioneer3.errors import ConfigError, PortPermissionError
from pioneer3.teleop import evdev
from pioneer3.teleop.evdev import BTN_SOUTH, Range, open_gamepad, read, request

# as a C program prints them that includes linux/input.h
EVIOCGNAME_256, EVIOCGBIT_KEY_256, EVIOCGBIT_ABS_256 = 0x81004506, 0x81004521, 0x81004523
EVIOCGABS_X, EVIOCGABS_Y = 0x80184540, 0x80184541


@dataclass
class Kernel:
    """Input devices as FIFOs in a folder, and what they are."""

    folder: Path
    facts: Path
    answers: dict[int, dict[int, bytes]]

    def add(self, number: int, name: str, *, button: int = BTN_SOUTH) -> Path:
        """Plug a device in that has one button and two axes."""
        path = self.folder / f"event{number}"
        os.mkfifo(path)
        self.answers[path.stat().st_ino] = {
            EVIOCGNAME_256: name.encode() + b"\0",
            EVIOCGBIT_KEY_256: (1 << button).to_bytes(96, "little"),
            EVIOCGBIT_ABS_256: b"\x03",
            EVIOCGABS_X: struct.pack("@6i", 130, 0, 255, 0, 15, 0),
            EVIOCGABS_Y: struct.pack("@6i", -5, -32768, 32767, 16, 128, 0),
        }
        words = f"{1 << button:x}".zfill(16 * 12)
        facts = self.facts / path.name / "device/capabilities/key"
        facts.parent.mkdir(parents=True)
        facts.write_text(" ".join(words[i : i + 16].lstrip("0") or "0" for i in range(0, 192, 16)))
        return path

    def ioctl(self, descriptor: int, number: int, buffer: bytes) -> bytes:
        """Answer as the kernel does."""
        answers = self.answers.get(os.fstat(descriptor).st_ino)
        if answers is None or number not in answers:
            raise OSError(errno.ENOTTY, "not an input device")
        return answers[number].ljust(len(buffer), b"\0")


@pytest.fixture
def kernel(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Kernel:
    """Run on a machine with its own input devices."""
    folder, facts = tmp_path / "dev", tmp_path / "sys"
    folder.mkdir()
    kernel = Kernel(folder, facts, {})
    monkeypatch.setattr(fcntl, "ioctl", kernel.ioctl)
    monkeypatch.setattr(evdev, "DEVICES", folder)
    monkeypatch.setattr(evdev, "FACTS", facts)
    return kernel


def open_files() -> int:
    return len(os.listdir("/proc/self/fd"))  # noqa: PTH208  the kernel's, not a folder's


def test_requests_have_the_kernels_numbers() -> None:
    assert request(0x06, 256) == EVIOCGNAME_256
    assert request(0x21, 256) == EVIOCGBIT_KEY_256
    assert request(0x23, 256) == EVIOCGBIT_ABS_256
    assert request(0x40, 24) == EVIOCGABS_X


def test_the_first_gamepad_is_taken_and_what_is_none_is_passed_over(kernel: Kernel) -> None:
    kernel.add(0, "Keyboard", button=30)
    kernel.add(10, "Second Pad")
    path = kernel.add(2, "First Pad")
    before = open_files()
    with open_gamepad() as device:
        assert device is not None
        assert (device.path, device.name) == (path, "First Pad")
        assert device.ranges == {0: Range(0, 255), 1: Range(-32768, 32767)}
        assert device.start == {0: 130, 1: -5}
    assert open_files() == before


def test_one_is_chosen_by_a_part_of_its_name_or_by_its_path(kernel: Kernel) -> None:
    kernel.add(1, "Wireless Controller")
    path = kernel.add(2, "Xbox Pad")
    before = open_files()
    for wanted in ("xbox", str(path)):
        with open_gamepad(wanted) as device:
            assert device is not None
            assert device.name == "Xbox Pad"
    with open_gamepad("steam") as device:
        assert device is None
    assert open_files() == before


def test_none_is_there_yet(kernel: Kernel) -> None:
    kernel.add(0, "Keyboard", button=30)
    with open_gamepad() as device:
        assert device is None
    with open_gamepad(str(kernel.folder / "event7")) as device:
        assert device is None


def test_a_path_that_is_no_gamepads_is_refused(kernel: Kernel) -> None:
    keyboard = kernel.add(0, "Keyboard", button=30)
    plain = kernel.folder / "notes"
    plain.write_text("nothing")
    before = open_files()
    for path in (keyboard, plain):
        with pytest.raises(ConfigError, match="is no gamepad"), open_gamepad(str(path)):
            pass
    assert open_files() == before


def test_a_gamepad_that_may_not_be_read_says_what_helps(
    kernel: Kernel, monkeypatch: pytest.MonkeyPatch
) -> None:
    keyboard = kernel.add(0, "Keyboard", button=30)
    real = os.open

    def forbidden(path: Path, flags: int) -> int:
        if path.name in shut:
            raise PermissionError(errno.EACCES, "permission denied")
        return real(path, flags)

    monkeypatch.setattr(os, "open", forbidden)
    shut = {keyboard.name}
    with open_gamepad() as device:  # only keyboards are forbidden, as for who sits at a desk
        assert device is None
    shut.add(kernel.add(3, "Pad").name)
    with pytest.raises(PortPermissionError, match="usermod -aG input"), open_gamepad():
        pass


@pytest.mark.realtime
async def test_what_it_says_is_read_until_it_is_unplugged(kernel: Kernel) -> None:
    path = kernel.add(1, "Pad")
    heard = b""
    with open_gamepad() as device:
        assert device is not None
        hand = os.open(path, os.O_WRONLY)

        async def listen() -> None:
            nonlocal heard
            async for chunk in read(device):
                heard += chunk

        listening = asyncio.ensure_future(listen())
        for part in (b"one", b"two"):
            os.write(hand, part)
            await asyncio.sleep(0.02)
        os.close(hand)  # a pipe ends where a device fails with ENODEV
        async with asyncio.timeout(5):
            await listening
    assert heard == b"onetwo"


@pytest.mark.realtime
async def test_a_device_that_fails_counts_as_unplugged(
    kernel: Kernel, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = kernel.add(1, "Pad")
    with open_gamepad() as device:
        assert device is not None
        hand = os.open(path, os.O_WRONLY)

        def fail(descriptor: int, size: int) -> bytes:
            raise OSError(errno.ENODEV, "no such device")

        monkeypatch.setattr(os, "read", fail)
        os.write(hand, b"x")
        async with asyncio.timeout(5):
            assert [chunk async for chunk in read(device)] == []
        monkeypatch.undo()
        os.close(hand)
