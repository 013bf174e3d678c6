"""Step variables (``Feed.x``) in actions, methods and other bodies of a POU whose chart was lowered."""

from __future__ import annotations

import re
from collections.abc import Mapping

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.network import Contact
from plcopen_sfc.model.pou import Pou

_OPERAND = re.compile(r"[\w.]+")
_STEP_DATA = frozenset({"x", "t", "_x", "_t"})


def with_step_data(pou: Pou, flags: Mapping[str, str], dialect: Dialect) -> Pou:
    """A copy of `pou` in which `flags` stand for what asks if a step is active; they are by the names of the steps.

    There are no steps any more, and names of steps would be those of variables that nothing declares. Raises
    `LoweringError` where the code does not keep what is asked for, or a contact cannot ask for it.
    """
    declared = {variable.name.casefold() for variable in pou.variables()}
    told = {name: flag for name, flag in flags.items() if name not in declared}
    changed = pou.model_copy(deep=True)
    for name, _, body in changed.named_bodies():
        _Replacing(told, dialect, changed.report_path_of(name)).replace_in(body)
    return changed


class ContactError(LoweringError):
    """A contact asks for a step, and no variable of the code tells of it."""


class _Replacing:
    """Replaces step variables in one body, of which `path` tells where it is."""

    def __init__(self, flags: Mapping[str, str], dialect: Dialect, path: str) -> None:
        self._flags, self._dialect, self._path = flags, dialect, path

    def replace_in(self, thing: object) -> None:
        """Replace them in all texts of a part of the model."""
        if isinstance(thing, list):
            for each in thing:
                self.replace_in(each)
        elif isinstance(thing, Model):
            texts = ("text",) if isinstance(thing, StBody | Expression) else ("variable", "expression")
            for name in type(thing).model_fields:
                value = getattr(thing, name)
                if name in texts and isinstance(value, str):
                    replaced = self._replaced(value)
                    if replaced != value:
                        if isinstance(thing, Contact) and not _OPERAND.fullmatch(replaced):
                            raise ContactError(
                                f"a contact cannot ask for {value}, which is {replaced} in the code",
                                location=Location(path=self._path),
                                hint="Step bits and flip-flops can be asked for.",
                            )
                        setattr(thing, name, replaced)
                else:
                    self.replace_in(value)

    def _replaced(self, text: str) -> str:
        if "." not in text:
            return text
        tokens = tokenize(text, self._dialect).tokens
        parts, end = [], 0
        for index in range(len(tokens) - 2):
            step, dot, asked = tokens[index : index + 3]
            flag = self._flags.get(step.value.casefold())
            before = tokens[index - 1].value if index else ""
            if flag is None or dot.value != "." or before == "." or asked.value.casefold() not in _STEP_DATA:
                continue
            if asked.value.casefold() != "x":
                raise LoweringError(
                    f"{step.value}.{asked.value} is not lowered yet: the code does not keep it",
                    location=Location(path=self._path),
                )
            alone = _OPERAND.fullmatch(flag) is not None or len(tokens) == 3
            parts += [text[end : step.span[0]], flag if alone else f"({flag})"]
            end = asked.span[1]
        return "".join([*parts, text[end:]])
