"""Access to the page: pairing, roles, sessions, rate limits, host names, certificates.

=====================  =====================================================================
module                 contents
=====================  =====================================================================
middleware             checks of every request: host name, origin, session and rate
access                 decides who is let in: pairing, sessions of requests, and rate limits
invitations            one-time tokens that let another device in
sessions               roles and sessions
certificate            the certificate for https
certificate_authority  a small certificate authority (X.509) of our own
hosts                  names and addresses of this machine
=====================  =====================================================================
"""
