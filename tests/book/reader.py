"""Somebody who reads a page of the book, and does all that it says.

    python -m tests.book.reader docs/tutorial/drive.md

The reader sits at a computer alone: its network has no other computer, its home and its folder are
new, and every program ends with the reader. The folder looks like the package's own; the
environment is activated. :mod:`tests.book.page` says what can stand in a page.
"""

import argparse
import fcntl
import os
import pty
import re
import signal
import struct
import subprocess
import sys
import termios
import time
from collections.abc import Iterable, Mapping, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from playwright.sync_api import Error as BrowserError

from docs.plots.tutorial import Desk, at_a_desk
from tests.book.page import Block, Comment, Picture, commands, steps
from tests.fleet.robots import DEVICES
from tests.fleet.terminal import COLUMNS, ROWS, Terminal

ROOT: Final = Path(__file__).parents[2]
PATIENCE: Final = 180.0
"""Longest wait for a command, on a busy machine [s]."""
ENDING: Final = 30.0
"""Longest wait for a command after Ctrl-C [s]."""
FIRST: Final = "First terminal"
"""Terminal of a block without a title."""
ALONE: Final = ("unshare", "--net", "--mount", "--pid", "--fork", "--kill-child", "--mount-proc")
"""Makes a computer of its own: network, mounts, and processes that end with the reader."""
_ADAPTER: Final = """\
set -e
plug() {  # device, vendor, product
    mkdir -p $1 bus/usb-serial usb-$1/interface/port/driver
    ln -s ../usb-$1/interface/port $1/device
    ln -s ../../../bus/usb-serial usb-$1/interface/port/subsystem
    echo $2 >usb-$1/idVendor; echo $3 >usb-$1/idProduct; echo 0600 >usb-$1/bcdDevice
    echo 00 >usb-$1/interface/bInterfaceNumber; echo 0 >usb-$1/interface/port/port_number
}
mount -t tmpfs tmpfs /sys/class/tty
cd /sys/class/tty
plug ttyUSB0 0403 6001
[ -z "$1" ] || plug ttyACM0 15d1 0000
[ -z "$1" ] || touch /dev/ttyACM0
[ -z "$1" ] || mount --bind "$1" /dev/ttyACM0
"""
"""Shows a USB adapter with a serial port, and a laser at "$1" if any, as the kernel would."""
_PROMPT: Final = re.compile(r"\[done (\d+)\]")
_SETTINGS: Final = "PS1= PS2=; stty -echo; PROMPT_COMMAND='printf \"\\n[done %s]\\n\" $?'\n"
_NUMBER: Final = re.compile(r"(?:\\-)?\d+(?:\\\.\d+)*")
_ANY_NUMBER: Final = r"-?\\d+(?:\\.\\d+)*"


class PageError(AssertionError):
    """The page and what happens differ."""


class Shell:
    """A terminal with a shell in it.

    Attributes:
        terminal: What is seen, and typed.
    """

    def __init__(self, folder: Path, environment: Mapping[str, str]) -> None:
        keyboard, screen = pty.openpty()
        fcntl.ioctl(screen, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
        process = subprocess.Popen(
            ["setsid", "--ctty", "--wait", "bash", "--noprofile", "--norc", "--noediting", "-i"],
            cwd=folder,
            env=environment,
            stdin=screen,
            stdout=screen,
            stderr=screen,
        )
        os.close(screen)
        self.terminal = Terminal(process, keyboard)
        self._since = self._block = 0
        self.terminal.type(_SETTINGS)
        self._await_prompt(ENDING)

    @property
    def said(self) -> str:
        """All that the last command has said."""
        return self.terminal.text[self._since :]

    @property
    def said_by_block(self) -> str:
        """All that the commands of the last block have said."""
        return self.terminal.text[self._block :]

    def begin_block(self) -> None:
        """Count from now on as one block; end what runs."""
        self.interrupt()
        self._block = len(self.terminal.text)

    @property
    def is_busy(self) -> bool:
        """Whether the last command runs."""
        self.terminal.read()
        return not _PROMPT.search(self.said)

    def type(self, command: str) -> None:
        """Type a command, of one line or more."""
        self._since = len(self.terminal.text)
        self.terminal.type(command)

    def status(self, patience: float = PATIENCE) -> int:
        """Wait for the end of the command; return its exit status."""
        return self._await_prompt(patience)

    def await_words(self) -> None:
        """Wait for the first line of a command that goes on."""
        self.terminal.until(lambda: "\n" in self.said, PATIENCE)
        if not self.is_busy:
            raise PageError(f"it has ended:\n{self.said}")

    def interrupt(self) -> None:
        """Press Ctrl-C if something runs, and wait until it has ended."""
        if self.is_busy:
            self.terminal.press("Ctrl-C")
            self._await_prompt(ENDING)

    def _await_prompt(self, patience: float) -> int:
        end = time.monotonic() + patience
        while not (found := _PROMPT.search(self.said)):
            if not self.terminal.read(0.05):
                raise PageError(f"the terminal is closed:\n{self.said}")
            if time.monotonic() > end:
                raise PageError(f"it has not ended after {patience:g} s:\n{self.said[-3000:]}")
        return int(found[1])


class Reader:
    """Does what a page says, in its order.

    Attributes:
        folder: Where commands are typed.
        log: What was done, with the time that it took.
    """

    def __init__(self, page: Path, folder: Path, desk: Desk | None = None) -> None:
        self.page = page
        self.folder = folder / "pioneer3"
        self.log: list[str] = []
        self._desk = desk
        self._home = folder / "home"
        self._shells: dict[str, Shell] = {}
        self._last = FIRST
        self._marks: dict[str, int] = {}
        self._furnish()

    def read(self) -> None:
        """Follow the page from its beginning to its end.

        Raises:
            PageError: something happens that the page does not say; with its line.
        """
        with ExitStack() as stack:
            stack.callback(self._leave)
            for step in steps(self.page.read_text("utf-8")):
                began = time.monotonic()
                try:
                    self._do(step)
                except (AssertionError, BrowserError) as error:
                    seen = f"\n{self._desk.page.inner_text('body')}" if self._desk else ""
                    raise PageError(f"{self.page}:{step.line}: {error}{seen}") from error
                self.log.append(f"line {step.line}: {time.monotonic() - began:.1f} s")

    def _do(self, step: Block | Picture | Comment) -> None:
        match step:
            case Picture(path=path):
                if self._desk:
                    self._desk.look(path)
            case Comment(word="beside", text=text):
                self._beside(text)
            case Comment(word="serial", text=text):
                self._plug_in(text)
            case Comment(word="end", text=name):
                self._at(name).interrupt()
            case Comment(word="press", text=text):
                for key in text.split():
                    self._shell.terminal.press(key)
                    self._shell.terminal.read(0.3)
            case Block(notes={"not run": _}):
                pass
            case Block(language="text"):
                self._compare(step.text)
            case Block(language="sh"):
                self._type(step)
            case Block(title=title) if title:
                self._write(title, step.text)
            case Block(language="python"):
                name = f".line{step.line}.py"
                self._write(name, step.text)
                self._shell.begin_block()
                self._run(f"python {name}\n", step)

    @property
    def _shell(self) -> Shell:
        """The terminal that was used last."""
        return self._at(self._last)

    def _at(self, name: str) -> Shell:
        if name not in self._shells:
            self._shells[name] = Shell(self.folder, self._environment())
        return self._shells[name]

    def _type(self, block: Block) -> None:
        self._last = block.title or FIRST
        self._shell.begin_block()
        *others, last = commands(block)
        if "each goes on" in block.notes:
            for command in (*others, last):
                self._try(command)
            return
        for command in others:
            self._run(command)
        self._run(last, block)

    def _run(self, command: str, block: Block | None = None) -> None:
        """Type a command, and wait for its end, if it is to end."""
        notes = block.notes if block else {}
        shell = self._shell
        shell.type(command)
        if "goes on" in notes:
            shell.await_words()
            return
        status = shell.status()
        if (status != 0) != ("fails" in notes):
            raise PageError(f"exit status {status} of: {command}{shell.said[-3000:]}")

    def _try(self, command: str) -> None:
        """Type a command, and wait until it has said something."""
        shell = self._shell
        shell.interrupt()
        shell.type(command)
        shell.terminal.until(lambda: bool(shell.said.strip()), PATIENCE)
        if not shell.is_busy and shell.status() != 0:
            raise PageError(f"it has failed: {command}{shell.said[-3000:]}")

    def _compare(self, text: str) -> None:
        """Wait until the terminal has said all lines of a text, in their order."""
        shell = self._shell
        pattern = expected(text.strip().splitlines())
        end = time.monotonic() + PATIENCE
        while not pattern.search(shell.said_by_block):
            is_over = not shell.is_busy and not pattern.search(shell.said_by_block)
            if is_over or time.monotonic() > end:
                raise PageError(f"it has not said:\n{text}\nbut:\n{shell.said_by_block[-3000:]}")
            shell.terminal.read(0.1)

    def _beside(self, command: str) -> None:
        """Start what the page says is there, unless it runs, and wait for its first line."""
        shell = self._at(f"beside {self.page.name}: {command}")
        if shell.is_busy:
            return
        shell.type(f"{command}\n")
        shell.await_words()

    def _plug_in(self, options: str) -> None:
        """Let a robot be at /dev/ttyUSB0, as the group `dialout` may use it."""
        self._beside(f"pioneer3 sim --pty --port 8199 {options}".rstrip())
        beside = next(reversed(self._shells.values()))
        beside.terminal.until(lambda: "Ctrl-C ends it" in beside.said, PATIENCE)
        robot, laser, *_ = *re.findall(r"/dev/pts/\d+", beside.said), ""
        subprocess.run(["mount", "-t", "tmpfs", "tmpfs", "/run"], check=True)
        subprocess.run(["sh", "-c", DEVICES, "sh", robot], check=True)
        subprocess.run(["sh", "-c", _ADAPTER, "sh", laser], check=True)

    def _write(self, name: str, text: str) -> None:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")

    def _furnish(self) -> None:
        """Make a home, and a folder that looks like the package's."""
        self.folder.mkdir(parents=True)
        for path in ROOT.iterdir():
            if path.name not in {".git", ".tools"}:
                (self.folder / path.name).symlink_to(path)
        caches = Path.home() / ".cache" / "pioneer3"  # compiled by scripts/setup
        (self._home / ".cache").mkdir(parents=True)
        if caches.exists():
            (self._home / ".cache" / "pioneer3").symlink_to(caches)

    def _environment(self) -> dict[str, str]:
        kept = ("LANG", "PYTHONDONTWRITEBYTECODE", "OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE")
        return {
            **{name: os.environ[name] for name in kept if name in os.environ},
            "HOME": str(self._home),
            "PATH": f"{self.folder / '.venv/bin'}:{os.defpath}:/usr/sbin:/sbin",
            "VIRTUAL_ENV": str(self.folder / ".venv"),
            "VIRTUAL_ENV_DISABLE_PROMPT": "1",
            "TERM": "xterm-256color",
            "COLUMNS": str(COLUMNS),
            "LINES": str(ROWS),
        }

    def _leave(self) -> None:
        """End what runs, the last first, and look whether anything has failed."""
        for name, shell in reversed(self._shells.items()):
            with suppress(PageError, OSError):
                shell.interrupt()
            self.log.append(f"--- {name}\n{shell.terminal.text}")
            shell.terminal.process.send_signal(signal.SIGKILL)
            shell.terminal.process.wait()


def expected(lines: Iterable[str]) -> re.Pattern[str]:
    """Return the pattern of lines in their order: numbers may differ, `...` is anything."""
    patterns = []
    for each in lines:
        words = [re.escape(word).replace(r"\.\.\.", ".*?") for word in each.split()]
        line = r"\s+".join(_NUMBER.sub(_ANY_NUMBER, word) for word in words)
        patterns.append(line.replace(r"\s+.*?\s+", r"\s+.*?"))
    return re.compile(".*?".join(patterns), re.DOTALL)


def alone(words: Sequence[str]) -> list[str]:
    """Return the command that runs `words` on a computer alone."""
    users = () if os.geteuid() == 0 else ("--map-root-user",)
    return [*ALONE, *users, "sh", "-c", 'ip link set lo up multicast on && exec "$@"', "sh", *words]


def main(arguments: Sequence[str]) -> None:
    """Read pages; print what was done."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("pages", nargs="+", type=Path)
    parser.add_argument("--pictures", type=Path, help="folder for pictures; none are kept without")
    parser.add_argument("--alone", action="store_true", help=argparse.SUPPRESS)
    chosen = parser.parse_args(arguments)
    if not chosen.alone:
        words = [sys.executable, "-m", "tests.book.reader", *arguments, "--alone"]
        sys.exit(subprocess.run(alone(words), cwd=ROOT, check=False).returncode)
    for page in chosen.pages:
        _read(page, chosen.pictures)


def _read(page: Path, pictures: Path | None) -> None:
    with TemporaryDirectory(prefix="reader-") as folder, ExitStack() as stack:
        has_pictures = "/images/tutorial/" in page.read_text("utf-8")
        desk = stack.enter_context(at_a_desk(pictures)) if has_pictures else None
        reader = Reader(page, Path(folder), desk)
        try:
            reader.read()
        except PageError as error:
            print("\n".join(reader.log))  # noqa: T201
            sys.exit(str(error))
        print("\n".join(reader.log))  # noqa: T201


if __name__ == "__main__":
    main(sys.argv[1:])
