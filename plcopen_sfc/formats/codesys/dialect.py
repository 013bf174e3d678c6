"""The CODESYS and TwinCAT dialect of TC6 XML: how it is told apart and written."""

from __future__ import annotations

from plcopen_sfc.formats.codesys import names
from plcopen_sfc.formats.codesys.data_writer import DATA_RANK, NATIVE_FIELDS, NATIVE_TEXTS, write_data
from plcopen_sfc.formats.plcopen.versions import V2_0
from plcopen_sfc.formats.plcopen.writing import Dialect
from plcopen_sfc.languages.standard_blocks import Tool

_NO_QUALIFIER = "CODESYS and TwinCAT offer N R S L D P SD DS SL"
_NO_LOGIC = "CODESYS takes an expression or a transition object; its importer may not read this"

LACKS = {
    **{f"qualifier {name}": _NO_QUALIFIER for name in ("P0", "P1", "DL", "None", "CALL", "ON", "OFF")},
    **{f"qualifier {name}": _NO_QUALIFIER for name in ("CS", "CU", "CD", "CR", "TL", "TD", "TR", "TF")},
    "macro-step": "exports of CODESYS and TwinCAT have no macro-steps; their importers may not read it",
    "condition in a body": _NO_LOGIC,
    "condition wired to logic": _NO_LOGIC,
    "logic in a chart": "charts of CODESYS hold no logic elements; its importer may not read them",
    "negated condition": "CODESYS has no negated conditions; its importer may not see the negation",
    "negated step output": "CODESYS has no negated step outputs; its importer may not see the negation",
    "negated action block": "CODESYS has no negated action blocks; its importer may not see the negation",
}
"""What charts can hold and these tools do not know (82 exports of SP4 to SP21 and TwinCAT 3.5.6 to 3.5.13)."""

CODESYS = Dialect(
    version=V2_0,
    text_element=names.XHTML_CHILD,
    declares_xhtml=False,
    states_actions=True,
    tool=Tool.CODESYS,
    native_fields=NATIVE_FIELDS,
    native_texts=NATIVE_TEXTS,
    data_writer=write_data,
    data_rank=DATA_RANK,
    lacks=LACKS,
)
