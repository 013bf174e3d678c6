"""Actions for tools that have none, such as TIA Portal: their statements stand where they are called."""

from __future__ import annotations

import re
from collections.abc import Mapping

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.edits import Edit, apply_edits
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.pou import Pou

_LEAVING = (n.Return, n.Goto, n.Label)
"""Statements that mean something else in another text."""


def with_actions_inside(pou: Pou, dialect: Dialect) -> Pou:
    """`pou` with the statements of its actions instead of their calls, each behind a comment with its name.

    Calls stay of actions that are drawn, that return or jump, and that call themselves.
    """
    texts = {a.name.casefold(): a.body.text for a in pou.actions if isinstance(a.body, StBody)}
    texts = {name: text for name, text in texts.items() if _can_stand_elsewhere(text, dialect)}
    if not texts or not any(isinstance(body, StBody) for body in pou.bodies):
        return pou
    bodies = [
        body.model_copy(update={"text": _inlined(body.text, texts, dialect), "markup": None})
        if isinstance(body, StBody)
        else body
        for body in pou.bodies
    ]
    return pou.model_copy(update={"bodies": bodies})


def _can_stand_elsewhere(text: str, dialect: Dialect) -> bool:
    parsed = parse_statements(text, dialect)
    return not parsed.problems and not any(isinstance(node, _LEAVING) for node in walk(parsed.tree))


def _inlined(text: str, texts: Mapping[str, str], dialect: Dialect) -> str:
    edits: list[Edit] = []
    for node in walk(parse_statements(text, dialect).tree):
        name = _called(node)
        if name is None or name.casefold() not in texts or node.span is None:
            continue
        others = {each: inside for each, inside in texts.items() if each != name.casefold()}
        inside = _inlined(texts[name.casefold()], others, dialect).strip("\n")
        end = re.compile(r"\s*;").match(text, node.span[1])
        stop = end.end() if end is not None else node.span[1]
        start = text.rfind("\n", 0, node.span[0]) + 1
        before = text[start : node.span[0]]
        indent = before[: len(before) - len(before.lstrip())]
        put = f"\n{indent}".join([f"// {name}", *inside.split("\n")])
        if before.strip():
            put = f"\n{indent}{put}"
        behind = text[stop : (text + "\n").index("\n", stop)]
        edits.append(Edit(node.span[0], stop, put if not behind.strip() else f"{put}\n{indent}"))
    return apply_edits(text, edits)


def _called(node: n.Node) -> str | None:
    """The name of what a statement calls without arguments."""
    call = node.call if isinstance(node, n.CallStatement) else None
    if isinstance(call, n.Call) and not call.arguments:
        call = call.callee
    return call.identifier if isinstance(call, n.Name) else None
