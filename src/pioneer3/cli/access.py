"""`pioneer3 access`: who may use the page of a robot that runs on this computer."""

from typing import Annotated, Literal

from cyclopts import App, Parameter

from pioneer3.cli.options import Json, TcpPort
from pioneer3.cli.process import write_json, write_line

WebPort = Annotated[TcpPort, Parameter(name="--web-port")]

access_app = App(
    name="access",
    help="""Show who is in at the page of a running pioneer3 run, invite and show out.

    Example: pioneer3 access invite --role viewer
    """,
)


@access_app.command(name="list")
def list_(*, web_port: WebPort = 8080, json: Json = False) -> int:
    """List the devices and scripts that are in.

    Args:
        web_port: TCP port of the page.
    """
    from pioneer3.web.api.http_client import sessions

    known = sessions(web_port)
    if json:
        write_json(known)
        return 0
    for one in known:
        write_line(f"{one.id:>3}  {one.role:6}  {one.kind:7}  {one.idle:6.0f} s ago  {one.name}")
    if not known:
        write_line("Nobody but this computer.")
    return 0


@access_app.command
def invite(*, role: Literal["viewer", "driver"] = "driver", web_port: WebPort = 8080) -> int:
    """Show a QR code that lets one more device in.

    Args:
        role: What it may do: look and stop, or drive as well.
        web_port: TCP port of the page.
    """
    from pioneer3.web.access.invitations import terminal_lines
    from pioneer3.web.api.http_client import invite as ask

    invitation = ask(web_port, role)
    for line in terminal_lines(invitation.url):
        write_line(line)
    write_line(invitation.url)
    write_line(f"Good once, for {invitation.seconds / 60:.0f} minutes.")
    return 0


@access_app.command
def revoke(session: str, *, web_port: WebPort = 8080) -> int:
    """Show a device or script out; what it drives stops.

    Args:
        session: Its number, from pioneer3 access list.
        web_port: TCP port of the page.
    """
    from pioneer3.web.api.http_client import revoke as ask

    ask(web_port, session)
    return 0
