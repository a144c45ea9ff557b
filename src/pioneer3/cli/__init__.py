"""The `pioneer3` command: parse, call one library function, print."""
