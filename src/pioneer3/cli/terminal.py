"""The terminal of a command, through rich: it shows text of others, and obeys none of it."""

from collections.abc import Iterator

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment

from pioneer3.names import printable_lines


class Terminal(Console):
    """Rich's console, which prints whatever it is given with :func:`printable_lines`.

    With `soft_wrap` the terminal breaks long lines, and not rich; a file or a program takes those
    of a `wide` one.
    """

    def __init__(
        self, *, stderr: bool = False, soft_wrap: bool = False, wide: bool = False
    ) -> None:
        super().__init__(highlight=False, stderr=stderr, soft_wrap=soft_wrap)
        if wide and not self.is_terminal:
            self.width = 400

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterator[Segment]:
        """Yield the pieces of a text; only rich's own control codes stay as they are."""
        for text, style, control in super().render(renderable, options):
            yield Segment(text if control else printable_lines(text), style, control)
