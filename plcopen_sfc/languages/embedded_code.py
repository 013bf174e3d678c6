"""Code in C in the texts of a project: ``{{ .. }}`` of Beremiz and OpenPLC."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.languages.names.pieces import Reading, pieces
from plcopen_sfc.languages.st.nodes import EmbeddedCode
from plcopen_sfc.languages.st.parsing import parse_statements
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.model.project import Project


def embedded_code(project: Project) -> Iterator[str]:
    """Yield the path of each text that has code in C among its statements."""
    for piece in pieces(project):
        if piece.reading is Reading.STATEMENTS and "{{" in piece.text:
            tree = parse_statements(piece.text, project.dialect).tree
            if any(isinstance(node, EmbeddedCode) for node in walk(tree)):
                yield piece.report_path
