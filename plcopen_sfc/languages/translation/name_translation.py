"""Names of variables, members and blocks: quotes and prefixes, and what is legal."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Collection, Sequence
from dataclasses import replace

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Quoting
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.languages.translation.renames import NameScope
from plcopen_sfc.languages.translation.translation_context import TITLES, NameTable, Notes, TranslationContext
from plcopen_sfc.languages.words import needs_quotes
from plcopen_sfc.model.dialect import Dialect

_OF_THE_LANGUAGE = frozenset({"EN", "ENO"})
_OF_OBJECTS = frozenset({"THIS", "SUPER"})
_LOCAL = (Quoting.LOCAL, Quoting.LOCAL_QUOTED)


class NameTranslator:
    """Writes the names of a text as the target does."""

    def __init__(
        self, tree: n.Node, source: Dialect, target: Dialect, context: TranslationContext, notes: Notes
    ) -> None:
        self._source, self._target = source, target
        self._context = context
        self._notes = notes
        self._locals = None if context.locals is None else NameTable.of(context.locals)
        self._types = NameTable.of(context.types)
        self._actions = NameTable.of(context.actions)
        self._members: set[str] = set()
        self._undeclared: dict[str, str] = {}
        self._local_names = ChainMap(self._undeclared, self._locals or {})
        self._hiding: Collection[str] = ()
        if source is Dialect.SCL and target is not Dialect.SCL:
            self._collect(tree)

    def _collect(self, tree: n.Node) -> None:
        """Find the names that others must not get, and those that hide global ones."""
        others = set()
        named: dict[str, str] = {}
        for node in walk(tree):
            if isinstance(node, n.Member | n.Argument) and node.name is not None:
                others.add(id(node.name))
                self._members.add(node.name.identifier.casefold())
            elif isinstance(node, n.Call) and isinstance(node.callee, n.Name) and not node.callee.quoting:
                others.add(id(node.callee))  # most likely a function of S7
            elif isinstance(node, n.Goto | n.LabelStatement):
                others.add(id(node.label))
            elif isinstance(node, n.Name) and node.quoting is not Quoting.GLOBAL and id(node) not in others:
                named.setdefault(node.identifier.casefold(), node.identifier)
        declared = self._locals or NameTable()
        self._undeclared.update((name, own) for name, own in named.items() if name not in declared)
        hiding = NameTable.of(self._context.hiding or ())
        if self._context.hiding is None or not hiding.keys().isdisjoint(self._undeclared):  # which others cannot have
            hiding = NameTable.of(map(self._local_name, declared.values()))
        self._hiding = ChainMap(NameTable.of(map(self._local_name, self._undeclared.values())), hiding)

    def _local_name(self, name: str) -> str:
        return self._context.renames.legal_name(NameScope.LOCAL, name, self._local_names, self._target)

    def inputs_of(self, name: n.Name) -> Sequence[str] | None:
        """Return the inputs of a function of the project; None for any other name."""
        if self.is_local(name) is True and name.identifier.casefold() not in self._context.functions:
            return None
        return self._context.functions.get(name.identifier.casefold())

    def is_action(self, name: n.Name) -> bool:
        """True for the name of an action or a method of the POU."""
        return name.identifier.casefold() in self._actions

    def is_instance(self, callee: Expression) -> bool:
        """True if a callee is known to be something that S7 calls."""
        return self._context.is_instance is not None and self._context.is_instance(callee)

    def is_local(self, name: n.Name) -> bool | None:
        """True if the POU declares `name`; None: that is not known."""
        if name.quoting is not Quoting.NONE:
            return name.quoting in _LOCAL
        return None if self._locals is None else name.identifier.casefold() in self._locals

    def type_of(self, expression: Expression) -> str:
        """Return the declared type of a variable, an element of an array or a member; "" where it is not known."""
        type = self._types.get(self._path(expression), "")
        if not type and isinstance(expression, n.Index):
            head, of, element = self.type_of(expression.base).upper().partition(" OF ")
            return element.strip() if of and head.startswith("ARRAY") else ""
        return type

    def _path(self, expression: Expression) -> str:
        match expression:
            case n.Name(identifier):
                return identifier.casefold()
            case n.Member(base, name):
                return f"{self._path(base)}.{name.identifier.casefold()}"
            case _:
                return ""

    def variable(self, name: n.Name) -> n.Name:
        """Return a name on its own."""
        if self._source is self._target:
            return name
        if self._target is Dialect.SCL:
            return self._for_scl(name)
        if name.identifier.upper() in _OF_THE_LANGUAGE:
            if self._source is Dialect.SCL and not name.quoting and self.is_local(name) is not True:
                reason = f"{name.identifier} is declared in no block: S7 has it in each"
                self._notes.add(Severity.ERROR, f"{reason}; left unchanged", name)
            return self._changed(name, name.identifier, Quoting.NONE)
        if self._source is not Dialect.SCL:
            return name
        if name.quoting is not Quoting.GLOBAL:
            return self._legal(name, self._local_name(name.identifier))
        new = self._context.renames.legal_name(NameScope.GLOBAL, name.identifier, self._hiding, self._target)
        return self._legal(name, new)

    def listed(self, name: n.Name | n.Member) -> Expression | None:
        """Return a global name that is another one in the target: see `TranslationContext.listed`."""
        first = name.base if isinstance(name, n.Member) else name
        if not isinstance(first, n.Name) or self.is_local(first) is not False:
            return None
        path = first.identifier if isinstance(name, n.Name) else f"{first.identifier}.{name.name.identifier}"
        parts = self._context.listed.get(path.casefold())
        if parts is None:
            return None
        to_scl = self._target is Dialect.SCL
        found: Expression = n.Name(parts[0], Quoting.GLOBAL if to_scl else Quoting.NONE)
        for part in parts[1:]:
            found = n.Member(found, self.member(n.Name(part)) if to_scl else n.Name(part))
        return replace(found, span=name.span)

    def member(self, name: n.Name) -> n.Name:
        """Return a name behind a dot, or of a parameter in a call."""
        if self._source is self._target:
            return name
        if self._target is Dialect.SCL:
            old = self._context.renames.old_name(NameScope.MEMBER, name.identifier) or name.identifier
            quoting = Quoting.GLOBAL if needs_quotes(old) and old.upper() not in _OF_THE_LANGUAGE else Quoting.NONE
            return self._changed(name, old, quoting)
        if self._source is not Dialect.SCL or name.identifier.upper() in _OF_THE_LANGUAGE:
            return name
        new = self._context.renames.legal_name(NameScope.MEMBER, name.identifier, self._members, self._target)
        return self._legal(name, new)

    def function(self, name: n.Name) -> n.Name:
        """Return the name of a function of the project where it is called."""
        return self._global(name) if self._target is Dialect.SCL else self.variable(name)

    def block(self, name: n.Name) -> n.Name:
        """The name of what is called, if it is no standard function: an instance, a function or a function block."""
        if self._target is Dialect.SCL and self._source is not Dialect.SCL and self.is_local(name) is not True:
            return self._global(name)
        return self.variable(name)

    def _for_scl(self, name: n.Name) -> n.Name:
        word = name.identifier.upper()
        if word in _OF_THE_LANGUAGE:
            return name
        if word in _OF_OBJECTS:
            self._notes.add(Severity.ERROR, f"{word} has no counterpart in SCL; left unchanged", name)
            return name
        local = self.is_local(name)
        if local is False:
            return self._global(name)
        old = self._context.renames.old_name(NameScope.LOCAL, name.identifier) or name.identifier
        if local is None:
            self._notes.add(
                Severity.WARNING, "it is not known which names are local: names got no # and no quotes", (0, 0)
            )
            return self._changed(name, old, Quoting.LOCAL_QUOTED if needs_quotes(old) else Quoting.NONE)
        return self._changed(name, old, Quoting.LOCAL_QUOTED if needs_quotes(old) else Quoting.LOCAL)

    def _global(self, name: n.Name) -> n.Name:
        old = self._context.renames.old_name(NameScope.GLOBAL, name.identifier) or name.identifier
        return self._changed(name, old, Quoting.GLOBAL)

    def _legal(self, name: n.Name, new: str) -> n.Name:
        if new != name.identifier:
            reason = f"{TITLES[self._target]} takes no such name"
            if name.quoting is Quoting.GLOBAL and name.identifier.casefold() in self._hiding:
                reason = "the global name is hidden by a local one"
            self._notes.add(Severity.INFO, f"{name.identifier} is called {new}: {reason}", name)
        return self._changed(name, new, Quoting.NONE)

    def _changed(self, name: n.Name, identifier: str, quoting: Quoting) -> n.Name:
        if identifier == name.identifier and quoting is name.quoting:
            return name
        return n.Name(identifier, quoting, span=name.span)
