"""Options that several commands share: one name, one help, one default each."""

from typing import Annotated

from cyclopts import Parameter
from cyclopts.validators import Number

DEFAULT_PORT = "tcp://localhost:8101"

Port = Annotated[str, Parameter(name=["--port", "-p"], env_var="PIONEER3_PORT")]
Baud = Annotated[int | None, Parameter(name=["--baud", "-b"], env_var="PIONEER3_BAUD")]
TcpPort = Annotated[int, Parameter(validator=Number(gte=0, lte=65535))]
