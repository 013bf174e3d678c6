"""Structured text of one dialect in another, with its layout, and with its comments, pragmas and regions."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal, TypeAlias

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.declarations.conditional_declarations import starts_condition
from plcopen_sfc.languages.grafcet_conditions import condition_problem
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.lexer import Comment, CommentKind, tokenize
from plcopen_sfc.languages.st.nodes import Node, Operator, Statements
from plcopen_sfc.languages.st.parsing import Parsed, parse_condition, parse_expression, parse_statements
from plcopen_sfc.languages.st.printing import render, tree_edits
from plcopen_sfc.languages.st.walking import transform, walk, with_statements
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.languages.translation.arithmetic_translation import ArithmeticTranslator
from plcopen_sfc.languages.translation.call_translation import is_called_otherwise
from plcopen_sfc.languages.translation.literal_translation import translated_literal
from plcopen_sfc.languages.translation.translation_context import (
    TITLES,
    Note,
    Notes,
    PartText,
    TranslationContext,
    family,
)
from plcopen_sfc.languages.translation.tree_translation import TreeTranslator, is_object, split_chains
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.report import Cause, CauseKind

_CARRIED = re.compile(r"\(\*pragma (\{[^}]*\})\*\)")
_REGION = re.compile(r"""\{\s*region\s*(?:\(?\s*(?:'([^\r\n]*)'|"([^\r\n]*)")\s*\)?\s*)?\}""", re.IGNORECASE)
_END_OF_REGION = re.compile(r"END_REGION", re.IGNORECASE)
_END_REGION = re.compile(r"\{\s*endregion\s*\}", re.IGNORECASE)


def translated_comment(kind: CommentKind, text: str, source: Dialect, target: Dialect, *, regions: bool) -> PartText:
    """Return a comment or a pragma of `source` in `target`, both families.

    ``//`` and ``(* *)`` are known to all, ``/* */`` to IEC 61131-3, ``(/* */)`` to SCL, pragmas to all but SCL: there
    they are in a comment that becomes a pragma again on the way back. `regions`: pragmas of regions become REGION.
    """
    if source is target or kind is CommentKind.LINE:
        return PartText(text)
    if kind is CommentKind.PRAGMA:
        return _pragma(text, target, regions=regions)
    pragma = _CARRIED.fullmatch(text)
    if pragma is not None and source is Dialect.SCL:
        return PartText(pragma[1])
    if text.startswith("(/*") and target is not Dialect.SCL:
        return PartText(f"(*{inside_comment(text[3:-3])}*)")
    if text.startswith("/*") and target is not Dialect.IEC:
        return PartText(f"(*{inside_comment(text[2:-2])}*)")
    return PartText(text)


def _pragma(text: str, target: Dialect, *, regions: bool) -> PartText:
    if starts_condition(text):
        why = f"{TITLES[target]} has no pragmas that leave statements out: they are always executed there"
        return PartText(
            text if target is not Dialect.SCL else f"(*pragma {inside_comment(text)}*)", Severity.ERROR, why
        )
    region, end = _REGION.fullmatch(text), _END_REGION.fullmatch(text)
    if target is not Dialect.SCL:
        if region is not None or end is not None:
            return PartText(text)
        return PartText(text, Severity.INFO, f"what a pragma means depends on the tool: {TITLES[target]} may ignore it")
    if regions and region is not None:
        return PartText(f"REGION {_unescaped(region[1] or region[2] or '')}".rstrip())
    if regions and end is not None:
        return PartText("END_REGION")
    reason = "SCL has no pragmas in statements: it became a comment"
    return PartText(f"(*pragma {inside_comment(text)}*)", Severity.WARNING, reason)


def inside_comment(text: str) -> str:
    """Return the text inside of a comment, so that nothing in it starts or ends one."""
    return text.replace("(*", "( *").replace("*)", "* )")


def with_block_comments(text: str, dialect: Dialect) -> str:
    """Return a text with ``(* *)`` for its comments up to the end of a line, so that text can follow them."""
    found = tokenize(text, dialect).comments if "//" in text else []
    lines = [each for each in found if each.kind is CommentKind.LINE]
    return apply_edits(text, [Edit(*each.span, f"(* {inside_comment(each.text[2:].strip())} *)") for each in lines])


def with_translated_comments(text: str, source: Dialect, target: Dialect, *, regions: bool) -> str:
    """Return a text whose program is in the target dialect already, with its comments and pragmas so too."""
    if not any(mark in text for mark in _MARKS):  # to look at every word takes a twentieth of a translation
        return text
    edits = []
    for comment in tokenize(text, target, comments_of=source).comments:
        new = translated_comment(comment.kind, comment.text, source, target, regions=regions).text
        if new == comment.text:
            continue
        start, end = comment.span
        if new.startswith("REGION") and re.match(r"[ \t]*[^\s]", text[end:]):
            new += "\n"  # its title goes to the end of the line
        edits.append(Edit(start, end, new))
    return apply_edits(text, edits)


_MARKS = ("//", "(*", "/*", "{")
"""What comments and pragmas begin with, in any dialect."""


def holds_regions(comments: Iterable[Comment]) -> bool:
    """True if there are pragmas of regions among comments."""
    return any(_REGION.fullmatch(comment.text) or _END_REGION.fullmatch(comment.text) for comment in comments)


def region_marks(title: str, dialect: Dialect) -> tuple[str, str]:
    """Return the lines around a region in a dialect: keywords in SCL, pragmas in all others."""
    if dialect is Dialect.SCL:
        return f"REGION {title}".rstrip(), "END_REGION"
    return f"{{region '{_escaped(title)}'}}", "{endregion}"


def region_edits(parsed: Parsed[Any]) -> list[Edit]:
    """Return the edits that make pragmas of the regions of SCL: other dialects have nothing else for them."""
    text = parsed.text
    ends = [end.span() for end in _END_OF_REGION.finditer(text)]
    ends = [end for end in ends if not any(a <= end[0] < b for a, b in (c.span for c in parsed.comments))]
    edits = []
    for node in walk(parsed.tree):
        if isinstance(node, n.RegionBlock) and node.span is not None:
            start, end = node.span
            first = min((text.find(mark, start, end) for mark in "\r\n" if mark in text[start:end]), default=end)
            last = max(each for each in ends if start < each[0] < end)
            begins, ends_with = region_marks(node.title, Dialect.CODESYS)
            edits += [Edit(start, first, begins), Edit(*last, ends_with)]
            if text[last[1] : end].endswith(";"):
                edits.append(Edit(end - 1, end, ""))
    return edits


def _escaped(title: str) -> str:
    return title.replace("$", "$$").replace("'", "$'").replace("}", "$7D")


def _unescaped(title: str) -> str:
    return re.sub(r"\$(7D|[$'\"])", lambda found: "}" if found[1] == "7D" else found[1], title)


@dataclass(frozen=True, slots=True)
class Translated:
    """A text in the target dialect. `parsed` is its tree, `notes` are about places in the source text."""

    text: str
    parsed: Parsed[Any]
    notes: tuple[Note, ...]

    @property
    def exact(self) -> bool:
        """True if it surely means the same: no note is more than an information."""
        return all(note.severity is Severity.INFO for note in self.notes)


TextKind: TypeAlias = Literal["statements", "expression", "condition"]
"""Kind of a text: a condition may also be written as in a TRANSITION, ``:= a AND b;``."""

_PARSERS: dict[str, Callable[[str, Dialect], Parsed[Any]]] = {
    "statements": parse_statements,
    "expression": parse_expression,
    "condition": parse_condition,
}


def translate_text(
    text: str,
    kind: TextKind,
    source: Dialect,
    target: Dialect,
    context: TranslationContext | None = None,
) -> Translated:
    """Return a text in another dialect. Never raises: text that does not parse stays unchanged, with a note for why."""
    return translate(_PARSERS[kind](text, source), target, context)


def translate(parsed: Parsed[Any], target: Dialect, context: TranslationContext | None = None) -> Translated:
    """Return a parsed text in another dialect.

    A part without a counterpart stays unchanged, with a note; so does a text that does not parse. Within a dialect,
    and between CODESYS and TwinCAT, nothing but references to steps changes. See `TranslationContext` for what the
    translation has to know of names.
    """
    context = context or TranslationContext()
    source, into = family(parsed.dialect), family(target)
    notes = Notes(parsed.text)
    if parsed.problems:
        if not isinstance(parsed.tree, Statements) and condition_problem(parsed.text, parsed.dialect) is None:
            reason, cause = "left unchanged: it is in the notation of GRAFCETs", Cause(CauseKind.GRAFCET_TEXT)
            notes.add(Severity.ERROR, reason, (0, len(parsed.text)), cause)
            return Translated(parsed.text, parsed, notes.in_order())
        for problem in parsed.problems:
            reason = f"left unchanged, because it cannot be read: {problem.message}"
            notes.add(Severity.ERROR, reason, problem.span, Cause(CauseKind.AS_IT_IS))
        return Translated(parsed.text, parsed, notes.in_order())
    if source is into and context.steps is None:
        return Translated(parsed.text, parsed if parsed.dialect is target else _parse(parsed, parsed.text, target), ())
    fitted = parsed.tree
    if context.type_of is not None and source is not into:
        fitted = ArithmeticTranslator(source, into, context, notes).fitted(parsed.tree)
    tree = TreeTranslator(fitted, source, into, context, notes).translated()
    edits = tree_edits(parsed, tree)
    if source is Dialect.SCL and into is not Dialect.SCL:
        edits += region_edits(parsed)
    text = apply_edits(parsed.text, edits)
    if into is Dialect.SCL and source is not into and isinstance(parsed.tree, Statements):
        text = _with_semicolons(text)
    regions = _regions_fit(parsed, text, source, into)
    for comment in parsed.comments:
        notes.take(translated_comment(comment.kind, comment.text, source, into, regions=regions), comment.span)
    text = with_translated_comments(text, source, into, regions=regions)
    result = _parse(parsed, text, target)
    if into is Dialect.IEC and source is not into and not result.problems:
        text = render(result, transform(result.tree, partial(with_statements, change=split_chains)))
        result = _parse(parsed, text, target)
    if result.problems and not notes.has_errors:
        why = result.problems[0].message
        notes.add(Severity.ERROR, f"{TITLES[target]} does not read the translation: {why}", (0, len(parsed.text)))
    return Translated(text, result, notes.in_order())


def _with_semicolons(text: str) -> str:
    """Return a text of SCL in which a semicolon is behind every END_IF and the like: CODESYS does without."""
    if "END_" not in text.upper():
        return text
    tokens = tokenize(text, Dialect.SCL).tokens
    pairs = zip(tokens, [*(token.value for token in tokens[1:]), ""], strict=False)
    ends = [token.span[1] for token, after in pairs if token.value.upper() in _ENDS and after != ";"]
    return apply_edits(text, [Edit(end, end, ";") for end in ends])


_ENDS = frozenset({"END_IF", "END_CASE", "END_FOR", "END_WHILE", "END_REPEAT"})


def _parse(like: Parsed[Any], text: str, dialect: Dialect) -> Parsed[Any]:
    if isinstance(like.tree, Statements):
        return parse_statements(text, dialect)
    return parse_condition(text, dialect)  # an expression, or one with what is around the condition of a transition


def _regions_fit(parsed: Parsed[Any], text: str, source: Dialect, target: Dialect) -> bool:
    """True if the pragmas of regions make whole regions, which SCL demands and others do not."""
    if target is not Dialect.SCL or not isinstance(parsed.tree, Statements) or not holds_regions(parsed.comments):
        return False
    plain = with_translated_comments(text, source, target, regions=False)
    marked = with_translated_comments(text, source, target, regions=True)
    return not parse_statements(marked, target).problems or bool(parse_statements(plain, target).problems)


def is_foreign(
    text: str,
    is_statements: bool,
    source: Dialect,
    target: Dialect,
    *,
    enumerations: Collection[str] = (),
    functions: Collection[str] = (),
) -> bool:
    """True if `text` has what `target` writes otherwise, beside names: ``q S= a``, ``a AND_THEN b``, ``a ** b``.

    So it does with the values of `enumerations`, named in lower case: ``Color.red`` and ``Color#red``. `functions`:
    those of the project, in lower case, which are called instead of standard ones.
    """
    parsed = parse_statements(text, source) if is_statements else parse_condition(text, source)
    return any(_is_foreign(node, family(target), enumerations, functions) for node in walk(parsed.tree))


_DURATIONS = frozenset({"T", "TIME", "LT", "LTIME"})


def _is_foreign(node: Node, target: Dialect, enumerations: Collection[str], functions: Collection[str]) -> bool:
    match node:
        case n.Member(base=base) | n.Call(callee=base) if is_object(base):
            return target is Dialect.CODESYS
        case n.Member(base=n.Name(identifier=name)) if name.casefold() in enumerations:
            return target is Dialect.IEC
        case n.Literal(text=text) if text.partition("#")[0].casefold() in enumerations:
            return target is Dialect.CODESYS
        case n.Literal(text=text) if target is Dialect.CODESYS and text.partition("#")[0].upper() in _DURATIONS:
            return translated_literal(text, Dialect.IEC, target) != PartText(text)
        case n.Operation(operator=Operator.POWER):
            return target is Dialect.CODESYS
        case n.Call(callee=n.Name(identifier=name)) if name.casefold() in functions:
            return False
        case n.Call():
            return is_called_otherwise(node, target)
        case n.Operation(operator=Operator.AND_THEN | Operator.OR_ELSE) | n.AssignmentExpression():
            return target is Dialect.IEC
        case n.Assignment(kind=kind):
            return target is Dialect.IEC and kind is not n.AssignmentKind.ASSIGN
        case n.Argument(value=None):
            return target is Dialect.IEC and not node.output
        case n.Dereference(base=base):
            return target is Dialect.IEC and is_object(base)
    return False
