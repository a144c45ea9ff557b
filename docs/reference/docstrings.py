"""Prepare docstrings for the book, where mkdocstrings reads them."""

import re
from copy import copy

from griffe import Alias, Attribute, Class, Extension, GriffeLoader, Module, Object

ROLE = re.compile(r":(?:attr|class|data|exc|func|meth|mod):`~?")
BLOCKING = re.compile(r"blocking\((\w+)\.(\w+)\)")


class Docstrings(Extension):
    """Takes Sphinx's roles out, and lends methods to the classes that make them blocking."""

    def on_instance(self, *, obj: Object, **_: object) -> None:
        """Take the roles out of a docstring."""
        if obj.docstring is not None:
            obj.docstring.value = ROLE.sub("`", obj.docstring.value)

    def on_package(self, *, pkg: Module, loader: GriffeLoader, **_: object) -> None:
        """Put signatures and docstrings of `Robot` in where `BlockingRobot` has its methods."""
        if pkg.name != "pioneer3":
            return
        for module in (pkg["runtime.blocking"], pkg["navigation.blocking"]):
            for one in module.classes.values():
                if not one.is_alias:
                    _lend(one, module)


def _lend(one: Class, module: Module) -> None:
    for name, member in list(one.members.items()):
        if not isinstance(member, Attribute):
            continue
        if found := BLOCKING.fullmatch(str(member.value)):
            function = _target(_target(module[found[1]]).all_members[found[2]])
            lent = copy(function)
            lent.labels = function.labels - {"async"}
            lent.parent = one
            one.members[name] = lent


def _target(named: Object | Alias) -> Object:
    return named.final_target if isinstance(named, Alias) else named
