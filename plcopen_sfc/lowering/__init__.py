"""Lowering: a chart as program code, with the proof that the code does the same.

`chart_lowering`     one chart as code in a copy of its project, compared with the chart; all charts of a project
`proof`              the comparison of code and chart
`written_code`       code in a file: its header, and its comparison as the tool of the file reads it
`lowering_losses`    what a chart holds and its code does not
`other_bodies`       actions and other bodies of the POU that refer to the chart
`enumeration_constants`  values of enumerations as constants of blocks in SCL
`faults`             the faults of textbook sequences, and the search for them
`case_objections`    why CASEs cannot hold a chart
`construction`       the choice of encoding and language, and the code as a POU
`grafcet`, `graph`   what only GRAFCET and S7-GRAPH have, such as interlocks and supervisions (`graph`)
`encodings`          what holds the situation: step bits, flip-flops, state variables with CASEs
`schedule`           what happens in a scan, and in which order
`actions`            when an action is executed, and its code
`reading`            a chart as syntax trees; what is not understood completely is refused
`code`               expressions, statements, declarations and memory; code as ST, FBD or LD
`lowering_options`   what a user can choose
`code_texts`         titles, comments and names in the code, in English and German
"""

from plcopen_sfc.lowering.chart_lowering import (
    LoweredPou as LoweredPou,
    LoweredProject as LoweredProject,
    lower as lower,
    lower_project as lower_project,
)
from plcopen_sfc.lowering.faults.fault_kinds import Fault as Fault, FaultKind as FaultKind, FaultScan as FaultScan
from plcopen_sfc.lowering.lowering_options import (
    ActionPlace as ActionPlace,
    Construction as Construction,
    Language as Language,
    OperatingMode as OperatingMode,
    States as States,
    Style as Style,
)
