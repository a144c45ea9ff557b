"""The HTTP API for scripts: one list of operations, from which routes and OpenAPI come."""
