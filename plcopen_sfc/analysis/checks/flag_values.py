"""Flags of steps in the conditions of a GRAFCET: which of them are TRUE together."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import replace
from functools import cached_property

from plcopen_sfc.languages.networks import NetworkExpression
from plcopen_sfc.languages.networks.wires import joined
from plcopen_sfc.languages.st import names_of, transform, walk
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.model.sfc import Transition
from plcopen_sfc.semantics.net import Net, NetStep

_TRUE = n.Literal("TRUE")
_FALSE = n.Literal("FALSE")
_MOST_VALUES = 64
"""Combinations of values that are written into a condition."""


class FlagValues:
    """Flags of a net.

    Args:
        hidden: Names in lower case that are variables, so that no flag has them.
        situations: Returns all situations of the net; None where not all are known.
        apart: Tells if two steps are never active together.
    """

    def __init__(
        self,
        net: Net,
        hidden: Collection[str],
        situations: Callable[[], Iterable[int] | None],
        apart: Callable[[NetStep, NetStep], bool],
    ) -> None:
        self._net = net
        self._situations = situations
        self._apart = apart
        self.bits = {flag.casefold(): bits for flag, bits in net.flags.items() if flag.casefold() not in hidden}
        """The steps (bits) that each flag tells of, by its name in lower case."""

    @cached_property
    def _steps(self) -> dict[str, NetStep]:
        """The steps by their own flags."""
        alone = {flag: bits for flag, bits in self.bits.items() if bits.bit_count() == 1}
        return {flag: self._net.steps[bits.bit_length() - 1] for flag, bits in alone.items()}

    @cached_property
    def _before(self) -> dict[int, list[int]]:
        """The steps (bits) before each transition of the model (by `id`), which may be several of the net."""
        found: dict[int, list[int]] = {}
        for each in self._net.transitions:
            found.setdefault(id(each.transition), []).append(each.pre)
        return found

    def while_active(self, sources: Iterable[str], tree: n.Expression) -> n.Expression:
        """Return a condition as it is while the steps with these names are active: their flags are TRUE.

        The flags of steps that are never active together with them are FALSE.
        """
        flags = {f"x{name}".casefold() for name in sources} & self.bits.keys()
        steps = [self._steps[flag] for flag in flags if flag in self._steps]
        others = {flag: self._steps[flag] for flag in names_of(tree) - flags if flag in self._steps}
        never = {flag for flag, other in others.items() if any(self._apart(step, other) for step in steps)}
        inner = {id(each.name) for each in walk(tree) if isinstance(each, n.Member)}

        def known(node: n.Node) -> n.Node:
            if isinstance(node, n.Name) and id(node) not in inner:
                flag = node.identifier.casefold()
                return _TRUE if flag in flags else _FALSE if flag in never else node
            return node

        return transform(tree, known)

    def possible(
        self, conditions: Sequence[NetworkExpression], transitions: Sequence[Transition]
    ) -> list[NetworkExpression]:
        """Return conditions, the first one TRUE only with such values of all their flags as a situation has.

        That is a situation in which all of `transitions` are enabled.
        """
        first, *others = conditions
        named = frozenset().union(*(names_of(each.tree) for each in conditions if each.tree is not None))
        flags = sorted(named & self.bits.keys())
        situations = self._situations() if flags and first.tree is not None else None
        if situations is None or first.tree is None:
            return [*conditions]
        before = [self._before.get(id(each), []) for each in transitions]
        values = {
            tuple(bool(situation & self.bits[flag]) for flag in flags)
            for situation in situations
            if all(any(not steps & ~situation for steps in each) for each in before)
        }
        if not 0 < len(values) <= _MOST_VALUES:
            return [*conditions]
        known = [joined(n.Operator.AND, [_valued(*each) for each in zip(flags, one, strict=True)]) for one in values]
        tree = joined(n.Operator.AND, [n.Parenthesized(first.tree), n.Parenthesized(joined(n.Operator.OR, known))])
        return [replace(first, tree=tree), *others]


def _valued(flag: str, value: bool) -> n.Expression:
    return n.Name(flag.upper()) if value else n.Unary(n.Operator.NOT, n.Name(flag.upper()))
