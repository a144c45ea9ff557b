"""What the system tells of its serial ports."""

from pathlib import Path

import pytest

from pioneer3.doctor.ports import (
    PortHolder,
    SerialPort,
    find_port,
    holders_of,
    is_console,
    is_serial,
    latency_of,
)


def process(proc: Path, pid: int, name: str, *files: str, master: int | None = None) -> None:
    """Make a process that has `files` open, and perhaps the master of a pseudo terminal."""
    (proc / str(pid) / "fd").mkdir(parents=True)
    (proc / str(pid) / "fdinfo").mkdir()
    (proc / str(pid) / "comm").write_text(f"{name}\n")
    for number, file in enumerate(files):
        (proc / str(pid) / "fd" / str(number)).symlink_to(file)
    if master is not None:
        (proc / str(pid) / "fd" / "99").symlink_to("/dev/ptmx")
        (proc / str(pid) / "fdinfo" / "99").write_text(f"pos:\t0\ntty-index:\t{master}\n")


def test_who_has_the_port_open_is_named(tmp_path: Path) -> None:
    process(tmp_path, 12, "ModemManager", "/dev/null", "/dev/ttyUSB0")
    process(tmp_path, 13, "bash", "/dev/pts/0")
    (tmp_path / "self").mkdir()
    assert list(holders_of("/dev/ttyUSB0", tmp_path)) == [PortHolder(12, "ModemManager")]


def test_we_are_no_rival_of_ourselves(tmp_path: Path) -> None:
    process(tmp_path, 12, "python", "/dev/ttyUSB0")
    assert not list(holders_of("/dev/ttyUSB0", tmp_path, me=12))


def test_who_holds_the_far_end_of_a_pseudo_terminal_is_no_rival(tmp_path: Path) -> None:
    process(tmp_path, 12, "pioneer3", "/dev/pts/7", master=7)
    process(tmp_path, 13, "screen", "/dev/pts/7", master=8)
    assert list(holders_of("/dev/pts/7", tmp_path)) == [PortHolder(13, "screen")]


def test_without_proc_nobody_is_named(tmp_path: Path) -> None:
    assert not list(holders_of("/dev/ttyUSB0", tmp_path / "none"))


@pytest.mark.parametrize(("text", "expected"), [("16\n", 16), ("junk", None), (None, None)])
def test_the_latency_timer_is_read_where_there_is_one(
    tmp_path: Path, text: str | None, expected: int | None
) -> None:
    if text is not None:
        folder = tmp_path / "bus/usb-serial/devices/ttyUSB0"
        folder.mkdir(parents=True)
        (folder / "latency_timer").write_text(text)
    assert latency_of("/dev/ttyUSB0", tmp_path) == expected


def test_the_kernel_console_is_recognised(tmp_path: Path) -> None:
    folder = tmp_path / "class/tty/console"
    folder.mkdir(parents=True)
    (folder / "active").write_text("tty0 ttyS0\n")
    assert is_console("/dev/ttyS0", tmp_path)
    assert not is_console("/dev/ttyS1", tmp_path)
    assert not is_console("/dev/pts/ttyS0", tmp_path)
    assert not is_console("/dev/ttyS0", tmp_path / "none")


@pytest.mark.parametrize(
    ("vendor", "product", "expected"),
    [
        (0x0403, 0x6001, "FTDI FT232R"),
        (0x0403, 0xFFFF, "FTDI 0403:ffff"),
        (0x1234, 0x0001, "Acme 1234:0001"),
        (None, None, None),
    ],
)
def test_the_chip_is_named_by_its_numbers(
    vendor: int | None, product: int | None, expected: str | None
) -> None:
    port = SerialPort(
        path="p", device="p", manufacturer="Acme", vendor_id=vendor, product_id=product
    )
    assert port.chip == expected


def test_only_serial_urls_have_a_port() -> None:
    assert find_port("tcp://localhost:8101") is None
    assert is_serial("/dev/ttyUSB0")
    assert not is_serial("tcp://localhost:8101")
    assert not is_serial("nonsense")


def test_a_port_that_is_not_there_has_nobody_in_the_way(tmp_path: Path) -> None:
    port = find_port(str(tmp_path / "ttyUSB9"))
    assert port is not None
    assert (port.allowed, port.holders, port.chip) == (True, (), None)
