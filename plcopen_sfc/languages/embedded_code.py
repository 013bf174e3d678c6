"""Code in C in the texts of a project: ``{{ .. }}`` of Beremiz and OpenPLC."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.languages.binding.text_sites import TextKind, text_sites
from plcopen_sfc.languages.st.nodes import EmbeddedCode
from plcopen_sfc.languages.st.parsing import parse_statements
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.model.project import Project


def embedded_code(project: Project) -> Iterator[str]:
    """Yield the path of each text that has code in C among its statements."""
    for text_site in text_sites(project):
        if text_site.reading is TextKind.STATEMENTS and "{{" in text_site.text:
            tree = parse_statements(text_site.text, project.dialect).tree
            if any(isinstance(node, EmbeddedCode) for node in walk(tree)):
                yield text_site.report_path
