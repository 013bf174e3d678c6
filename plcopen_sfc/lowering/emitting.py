"""Lowered code as the body of a POU: structured text, FBD or LD."""

from __future__ import annotations

from collections.abc import Callable

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.networks import DrawingRules, DrawnFbd, DrawnLd, declared_rules, draw_fbd, draw_ld
from plcopen_sfc.languages.networks.numbering import apart
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.lowering.code import Code, CodeNetwork, TextNetwork
from plcopen_sfc.model.body import FbdBody, LdBody, StBody
from plcopen_sfc.model.network import LogicNetwork
from plcopen_sfc.model.types import Variable


def structured_text(code: Code, dialect: Dialect) -> StBody:
    """A paragraph for each network, its title and comment before it."""
    paragraphs = [_paragraph(network, dialect) for network in code.networks]
    return StBody(text="\n\n".join(paragraphs) + "\n")


def function_block_diagram(code: Code, dialect: Dialect, declared: list[Variable]) -> FbdBody:
    """A network of FBD for each network. Raises `LoweringError` for what cannot be drawn."""
    return FbdBody(networks=_drawn(code, draw_fbd, declared_rules(declared, dialect)))


def ladder_diagram(code: Code, dialect: Dialect, declared: list[Variable]) -> LdBody:
    """A network of LD for each network. Raises `LoweringError` for what cannot be drawn."""
    return LdBody(networks=_drawn(code, draw_ld, declared_rules(declared, dialect)))


def _paragraph(network: CodeNetwork | TextNetwork, dialect: Dialect) -> str:
    comments = [network.title, *network.comment.splitlines()]
    heading = [f"// {line}".rstrip() for line in comments if line]
    text = network.text if isinstance(network, TextNetwork) else print_node(n.Statements(network.statements), dialect)
    return "\n".join([*heading, text])


def _drawn(code: Code, draw: Callable[..., DrawnFbd | DrawnLd], rules: DrawingRules) -> list[LogicNetwork]:
    found: list[LogicNetwork] = []
    for network in code.networks:
        if isinstance(network, TextNetwork):
            raise LoweringError("structured text is no network", location=Location(path=f"network {network.title}"))
        drawn = draw(network.statements, rules)
        if drawn.problems:
            raise LoweringError(
                f"this cannot be drawn: {drawn.problems[0].message}", location=Location(path=f"network {network.title}")
            )
        for sheet in drawn.body.networks:
            sheet.title = network.title
            sheet.comment = network.comment or None
            found.append(sheet)
    return apart(found)[0]
