"""Networks in exports of CoDeSys 2.3 (``_LD_BODY``, ``_FBD_BODY``) as structured text.

A network is a list of words, one in a line, in prefix notation: each expression is followed by ``_EXPRESSION`` and by
its polarity. No export at hand has one. This reads what three programs by others write, two for LD and one
for FBD: contacts in series and in parallel, coils that assign, set and reset, function blocks with operands. A body
with anything else, such as a jump, is not understood, and kept as it is.

::

    _LD_ASSIGN
    _LD_AND
    _LD_OPERATOR : 2
    _LD_CONTACT
    Start
    _EXPRESSION
    _POSITIV
    ..
    ENABLELIST : 0
    ENABLELIST_END
    _OUTPUTS : 1
    _OUTPUT
    _POSITIV
    _NO_SET
    Motor
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

from plcopen_sfc.languages.networks.box_trees import BoxTrees, UnknownNetworkError, is_box_tree
from plcopen_sfc.languages.st import names_of, parse_expression, print_node
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Operator
from plcopen_sfc.languages.standard_blocks import BlockKind, Tool, standard_block
from plcopen_sfc.model.dialect import Dialect

EXPORTS = "codesys23"
"""Source of the bodies that exports of CoDeSys 2.3 have."""
SOURCES = {EXPORTS: "CoDeSys 2.3", "twincat": "TwinCAT"}
"""Sources of bodies in which there may be networks, and their tools."""
KNOWN_SECTIONS = frozenset("LIBRARY RESOURCE PLC_CONFIGURATION TASK_CONFIGURATION VISUALISATION VAR_CONFIG".split())
"""Words that begin sections of exports that are no programs; those that begin with an underscore are such, too."""
_Thing = TypeVar("_Thing")
_COUNT = re.compile(r"(\w+)\s*:\s*(\d+)\s*;?")
_POLARITY = {"_POSITIV": False, "_NEGATIV": True}
_SERIES = {"_LD_AND": Operator.AND, "_LD_OR": Operator.OR}
_OPEN = "???"
"""Operand of a pin that nothing is connected to."""


def network_statements(content: str) -> str | None:
    """Return the statements that do what the networks of a body do; None where they are not understood."""
    networks = _read(content)
    return print_node(n.Statements(tuple(networks.done))) if networks is not None else None


def network_operands(content: str) -> Sequence[tuple[int, n.Expression]] | None:
    """Return the operands with the offsets where they begin; None where the networks are not understood."""
    networks = _read(content)
    return networks.operands if networks is not None else None


def _read(content: str) -> BoxTrees | _Networks | None:
    try:
        return BoxTrees(content) if is_box_tree(content) else _Networks(content)
    except UnknownNetworkError:
        return None


@dataclass(frozen=True, slots=True)
class _Output:
    target: n.Expression
    negated: bool
    is_set: bool


class _Networks:
    """The networks of a body. Raises `UnknownNetworkError` at a word that no known program writes there."""

    def __init__(self, content: str) -> None:
        found = [*re.finditer(r"\S(?:[^\r\n]*\S)?", content)]
        self._words = [word.group() for word in found]
        self._starts = [word.start() for word in found]
        self._place = 0
        self.done: list[n.Statement] = []
        self.operands: list[tuple[int, n.Expression]] = []
        body = self._word()
        if body not in ("_LD_BODY", "_FBD_BODY"):
            raise UnknownNetworkError
        for _ in range(self._count("_NETWORKS")):
            self._network(ladder=body == "_LD_BODY")
        if self._place != len(self._words):
            raise UnknownNetworkError

    # -- words

    def _word(self) -> str:
        if self._place >= len(self._words):
            raise UnknownNetworkError
        self._place += 1
        return self._words[self._place - 1]

    def _expect(self, *words: str) -> None:
        for word in words:
            if self._word() != word:
                raise UnknownNetworkError

    def _count(self, word: str) -> int:
        found = _COUNT.fullmatch(self._word())
        if found is None or found[1] != word:
            raise UnknownNetworkError
        return int(found[2][:4])

    def _several(self, word: str, read: Callable[[], _Thing]) -> list[_Thing]:
        return [read() for _ in range(self._count(word))]

    def _operand(self) -> n.Expression:
        parsed = parse_expression(self._word(), Dialect.CODESYS)
        if parsed.problems:
            raise UnknownNetworkError
        self.operands.append((self._starts[self._place - 1], parsed.tree))
        return parsed.tree

    def _is_negated(self) -> bool:
        self._expect("_EXPRESSION")
        return self._polarity()

    def _polarity(self) -> bool:
        word = self._word()
        if word not in _POLARITY:
            raise UnknownNetworkError
        return _POLARITY[word]

    # -- networks

    def _network(self, *, ladder: bool) -> None:
        self._expect("_NETWORK", "_COMMENT")
        while self._word() != "_END_COMMENT":
            pass
        self._expect("_LD_ASSIGN" if ladder else "_ASSIGN")
        value = self._rung() if ladder else self._box()
        value = _negated_if(value, self._is_negated())
        if ladder:
            if self._count("ENABLELIST"):
                raise UnknownNetworkError
            self._expect("ENABLELIST_END")
        self._assign(value, self._several("_OUTPUTS", self._output))

    def _output(self) -> _Output:
        self._expect("_OUTPUT")
        negated, word = self._polarity(), self._word()
        if word not in ("_SET", "_NO_SET"):
            raise UnknownNetworkError
        return _Output(self._operand(), negated, word == "_SET")

    def _assign(self, value: n.Expression, outputs: list[_Output]) -> None:
        read = names_of(value)
        for output in outputs:
            if output is not outputs[-1] and names_of(output.target) & read:
                raise UnknownNetworkError  # all outputs get the same value, and the next would compute it again
            if output.is_set:
                stored = n.Assignment(output.target, n.Literal("FALSE" if output.negated else "TRUE"))
                self.done.append(n.If((n.Branch(value, (stored,)),)))
            else:
                self.done.append(n.Assignment(output.target, _negated_if(value, output.negated)))

    def _rung(self) -> n.Expression:
        word = self._word()
        if word == "_EMPTY":  # the rail alone
            return n.Literal("TRUE")
        if word == "_LD_CONTACT":
            operand = self._operand()
            return _negated_if(operand, self._is_negated())
        if word not in _SERIES:
            raise UnknownNetworkError
        parts = self._several("_LD_OPERATOR", self._rung)
        if not parts:
            raise UnknownNetworkError
        joined = parts[0]
        for part in parts[1:]:
            joined = n.Operation(_SERIES[word], (joined, part))
        return _negated_if(joined, self._is_negated())

    def _box(self) -> n.Expression:
        word = self._word()
        if word == "_OPERAND":
            negated = self._is_negated()
            return _negated_if(self._operand(), negated)
        if word != "_FUNCTIONBLOCK":
            raise UnknownNetworkError
        instance = self._operand()
        given = self._several("_BOX_EXPR", self._pin)
        negated = self._is_negated()
        block = standard_block(self._word(), Tool.CODESYS)
        others = self._several("_OUTPUTS", self._output)
        if block is None or block.kind is not BlockKind.FUNCTION_BLOCK:
            raise UnknownNetworkError
        inputs, outputs = (
            [n.Name(block.tool_pin(pin.name, Tool.CODESYS)) for pin in pins] for pins in (block.inputs, block.outputs)
        )
        if len(given) > len(inputs) or len(others) >= len(outputs):
            raise UnknownNetworkError
        pairs = zip(inputs, given, strict=False)
        arguments = tuple(n.Argument(value, name) for name, value in pairs if value is not None)
        self.done.append(n.CallStatement(n.Call(instance, arguments)))
        for name, output in zip(outputs[1:], others, strict=False):
            self._assign(n.Member(instance, name), [output])
        return _negated_if(n.Member(instance, outputs[0]), negated)

    def _pin(self) -> n.Expression | None:
        if self._words[self._place : self._place + 1] == ["_OPERAND"] and self._words[self._place + 3 :][:1] == [_OPEN]:
            self._place += 4
            return None
        return self._box()


def _negated_if(value: n.Expression, negated: bool) -> n.Expression:
    return n.Unary(Operator.NOT, value) if negated else value
