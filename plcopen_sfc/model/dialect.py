"""The dialects of structured text that the library reads and writes."""

from __future__ import annotations

from enum import StrEnum


class Dialect(StrEnum):
    """A dialect of structured text.

    IEC: IEC 61131-3 ed. 3. CODESYS: CODESYS V3 and V2.3. TWINCAT: TwinCAT 3, which is CODESYS V3 in its language. SCL:
    Siemens SCL of TIA Portal and STEP 7 (names of locals with ``#``, of globals in quotes).
    """

    IEC = "iec"
    CODESYS = "codesys"
    TWINCAT = "twincat"
    SCL = "scl"


STRING_LENGTHS = {Dialect.SCL: "254", Dialect.CODESYS: "80"}
"""Length of a string, in characters, whose declaration gives none; IEC 61131-3 leaves it to the tool."""
