"""Any command by its number (facts.md 8.13)."""

from collections import deque

from pioneer3.demo.modes.cockpit import Cockpit
from pioneer3.demo.modes.mode import Mode
from pioneer3.demo.modes.row import Row
from pioneer3.errors import CommandError
from pioneer3.robot.devices import parse_typed

LONGEST = 40
"""Characters of a command."""
REMEMBERED = 10
HELP = (
    "MOTION COMMANDS GO PAST LIMITS AND GUARDS",
    "digits, space, -: type",
    "enter: send",
    "32 10 -10: a command, then nothing, an integer or two bytes",
)


def command(cockpit: Cockpit) -> Mode:
    """Return the mode that sends what is typed."""
    prompt = _Prompt(cockpit)
    return Mode(
        key="d",
        name="command",
        help=HELP,
        by_hand=True,
        on_key=prompt.on_key,
        row=lambda: Row(tail=f"> {prompt.text}"),
        details=lambda: tuple(prompt.sent),
    )


class _Prompt:
    def __init__(self, cockpit: Cockpit) -> None:
        self._cockpit = cockpit
        self.text = ""
        self.sent: deque[str] = deque(maxlen=REMEMBERED)

    def on_key(self, key: str) -> bool:
        match key:
            case "enter":
                self._send()
            case "backspace":
                self.text = self.text[:-1]
            case "space":
                self._add(" ")
            case "-":
                if self.text.endswith(" "):
                    self._add("-")
            case _ if key.isascii() and key.isdecimal():
                self._add(key)
            case _:
                return False
        return True

    def _add(self, character: str) -> None:
        if len(self.text) < LONGEST:
            self.text += character

    def _send(self) -> None:
        line, self.text = self.text, ""
        robot = self._cockpit.robot
        if robot.supervisor.pilot.emergency:
            self._note("not sent: the emergency stop is latched")
            return
        try:
            robot.send_unsafe(parse_typed(line))
        except CommandError as error:
            self._note(f"not sent: {error}")
            return
        number, *arguments = line.split()
        what = {0: "", 1: ", integer ", 2: ", bytes "}[len(arguments)] + " ".join(arguments)
        self._note(f"sent: command {number}{what}")

    def _note(self, text: str) -> None:
        self.sent.append(text)
        self._cockpit.say(text)
