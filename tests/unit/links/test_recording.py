"""A recording whose disk takes no more."""

from io import StringIO

from pioneer3.links.tap import FROM_ROBOT, WireRecording


class FullDisk(StringIO):
    """Takes so many lines."""

    name = "run.txt"

    def __init__(self, room: int) -> None:
        super().__init__()
        self.room = room

    def write(self, text: str) -> int:
        if not self.room:
            raise OSError(28, "No space left on device")
        self.room -= 1
        return super().write(text)


def test_a_full_disk_ends_the_recording_and_is_told() -> None:
    disk = FullDisk(room=1)
    recording = WireRecording(disk, lambda: 2.0, began=0.0)
    recording.note(FROM_ROBOT, b"\x01")
    assert recording.failure == ""
    recording.note(FROM_ROBOT, b"\x02")
    assert recording.failure == "No space left on device"
    disk.room = 9
    recording.note(FROM_ROBOT, b"\x03")
    assert disk.getvalue() == "2.000000 S>C 1 01\n"
