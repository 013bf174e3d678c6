"""Names of what CODESYS V3 and TwinCAT 3 add to PLCopen XML.

The attribute table is the one that SFC editors of both tools write into their own files (TwinCAT ``.TcPOU`` archives,
attribute descriptions); the data names are those of exports from CODESYS V3.5 SP4 to SP21 and TwinCAT 3.5.6 to 3.5.13.
"""

from __future__ import annotations

PREFIX = "http://www.3s-software.com/plcopenxml/"

APPLICATION = PREFIX + "application"
POU = PREFIX + "pou"
DATA_TYPE = PREFIX + "datatype"
GLOBAL_VARS = PREFIX + "globalvars"
METHOD = PREFIX + "method"
POU_INHERITANCE = PREFIX + "pouinheritance"
TYPE_INHERITANCE = PREFIX + "datatypeinheritance"
SFC_ELEMENT = PREFIX + "sfc/element"
SFC_SETTINGS = PREFIX + "sfcsettings"
PLAIN_TEXT = PREFIX + "interfaceasplaintext"
ATTRIBUTES = PREFIX + "attributes"
OBJECT_ID = PREFIX + "objectid"
MIXED_LIST = PREFIX + "mixedattrsvarlist"
PROJECT_STRUCTURE = PREFIX + "projectstructure"
TASK_SETTINGS = PREFIX + "tasksettings"
CALL_TYPE = PREFIX + "fbdcalltype"
ELEMENT_TYPE = PREFIX + "fbdelementtype"
FBD_ATTRIBUTES = PREFIX + "fbd/implementationattributes"
ST_CODE = PREFIX + "stcode"

# Attributes of chart elements, in the order in which the tools write them
NAME = "38391c6d-6d4a-42f8-8ee7-9f45e5adafa8"
COMMENT = "7d894980-aeea-405c-a0f6-e2b26429c58f"
EXCLUDE = "01580b27-6378-448b-8ecb-0e4b795b58d6"
SYMBOL = "bc882c11-1e91-4dd8-a6b8-2075724ed18b"
INITIAL = "6844a48e-46c2-4cc8-a185-a478f3b99cc0"
DUPLICATION = "62e1754b-7629-4e63-9cec-10ae0c536f1f"
MIN_TIME = "cacf1a68-236e-47c2-b7b1-1cf9199718cb"
MAX_TIME = "b693554c-1b01-4a8d-afde-9e3a46f7465d"
MAIN_ACTION = "700a583f-b4d4-43e4-8c14-629c7cd3bec8"
ENTRY_ACTION = "a6b08bd8-b696-47e3-9cbf-7408b61c9ff8"
EXIT_ACTION = "a2621e18-7de3-4ea6-ae6d-89e9e0b7befd"
QUALIFIER = "e174fc0d-80b0-4a9e-a530-ca239c249a50"
PARALLEL = "23bdaa98-72ec-41f7-817b-9dede5697086"
MONITORING = "8294df19-5962-4dee-a874-1051dabb0e3e"

SYMBOL_VALUES = ("unspecified", "none", "read", "write", "readWrite")
MONITORING_VALUES = ("none", "variable", "call")

XHTML_CHILD = "xhtml"
"""The XHTML element that holds texts and code in exports."""
