"""The CODESYS and TwinCAT dialect of TC6 XML: how it is told apart and written."""

from __future__ import annotations

from plcopen_sfc.formats.codesys import names
from plcopen_sfc.formats.codesys.data_writer import DATA_RANK, NATIVE_FIELDS, write_data
from plcopen_sfc.formats.plcopen.versions import V2_0
from plcopen_sfc.formats.plcopen.writing import Dialect

CODESYS = Dialect(
    version=V2_0,
    text_element=names.XHTML_CHILD,
    declares_xhtml=False,
    states_actions=True,
    native_fields=NATIVE_FIELDS,
    data_writer=write_data,
    data_rank=DATA_RANK,
)
