"""Switches: off unless given, without a `--no-` twin."""

from typing import Annotated

from cyclopts import Parameter

Flag = Annotated[bool, Parameter(negative=())]
