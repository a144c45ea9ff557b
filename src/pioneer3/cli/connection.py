"""The options that say which robot is meant, the same in every command."""

from typing import Annotated, Final

from cyclopts import Parameter

DEFAULT_PORT: Final = "tcp://localhost:8101"

Port = Annotated[str, Parameter(name=["--port", "-p"], env_var="PIONEER3_PORT")]
Baud = Annotated[int | None, Parameter(name=["--baud", "-b"], env_var="PIONEER3_BAUD")]
Json = Annotated[bool, Parameter(name="--json", negative=())]
