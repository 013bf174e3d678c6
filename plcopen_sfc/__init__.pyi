"""The public names of the package and where they are: the one list, which `__init__.py` and type checkers read."""

from plcopen_sfc.analysis.equivalence import equivalent as equivalent
from plcopen_sfc.analysis.verdict import UntestedError as UntestedError
from plcopen_sfc.analysis.verdict import (
    Verdict as Verdict,
)
from plcopen_sfc.analysis.verdict import (
    VerdictKind as VerdictKind,
)
from plcopen_sfc.api import (
    check_syntax as check_syntax,
)
from plcopen_sfc.api import (
    convert as convert,
)
from plcopen_sfc.api import (
    dumps as dumps,
)
from plcopen_sfc.api import (
    load as load,
)
from plcopen_sfc.api import (
    loads as loads,
)
from plcopen_sfc.api import (
    save as save,
)
from plcopen_sfc.checking import check as check
from plcopen_sfc.diagnostics import DamagedSourceError as DamagedSourceError
from plcopen_sfc.diagnostics import (
    Diagnostic as Diagnostic,
)
from plcopen_sfc.diagnostics import (
    Severity as Severity,
)
from plcopen_sfc.documents.lowered import (
    LoweredFile as LoweredFile,
)
from plcopen_sfc.documents.lowered import (
    lower_to_file as lower_to_file,
)
from plcopen_sfc.errors import (
    ArgumentError as ArgumentError,
)
from plcopen_sfc.errors import (
    FileAccessError as FileAccessError,
)
from plcopen_sfc.errors import (
    FormatError as FormatError,
)
from plcopen_sfc.errors import (
    InputError as InputError,
)
from plcopen_sfc.errors import (
    Location as Location,
)
from plcopen_sfc.errors import (
    LossError as LossError,
)
from plcopen_sfc.errors import (
    LoweringError as LoweringError,
)
from plcopen_sfc.errors import (
    ModelError as ModelError,
)
from plcopen_sfc.errors import (
    OldVersionError as OldVersionError,
)
from plcopen_sfc.errors import (
    SfcError as SfcError,
)
from plcopen_sfc.errors import (
    SimulationError as SimulationError,
)
from plcopen_sfc.lowering import (
    LoweredPou as LoweredPou,
)
from plcopen_sfc.lowering import (
    lower as lower,
)
from plcopen_sfc.model import (
    Action as Action,
)
from plcopen_sfc.model import (
    ActionAssociation as ActionAssociation,
)
from plcopen_sfc.model import (
    ActionEvent as ActionEvent,
)
from plcopen_sfc.model import (
    ActionKind as ActionKind,
)
from plcopen_sfc.model import (
    Dialect as Dialect,
)
from plcopen_sfc.model import (
    Expression as Expression,
)
from plcopen_sfc.model import (
    Interface as Interface,
)
from plcopen_sfc.model import (
    Pou as Pou,
)
from plcopen_sfc.model import (
    PouKind as PouKind,
)
from plcopen_sfc.model import (
    Project as Project,
)
from plcopen_sfc.model import (
    Qualifier as Qualifier,
)
from plcopen_sfc.model import (
    SectionKind as SectionKind,
)
from plcopen_sfc.model import (
    SfcBody as SfcBody,
)
from plcopen_sfc.model import (
    SfcNetwork as SfcNetwork,
)
from plcopen_sfc.model import (
    StBody as StBody,
)
from plcopen_sfc.model import (
    Step as Step,
)
from plcopen_sfc.model import (
    Supervised as Supervised,
)
from plcopen_sfc.model import (
    Transition as Transition,
)
from plcopen_sfc.model import (
    Variable as Variable,
)
from plcopen_sfc.model import (
    VariableSection as VariableSection,
)
from plcopen_sfc.report import (
    ConversionReport as ConversionReport,
)
from plcopen_sfc.report import (
    Converted as Converted,
)
from plcopen_sfc.report import (
    Outcome as Outcome,
)
from plcopen_sfc.semantics.inputs import (
    CsvInputs as CsvInputs,
)
from plcopen_sfc.semantics.inputs import (
    RandomInputs as RandomInputs,
)
from plcopen_sfc.semantics.simulation import simulate as simulate
from plcopen_sfc.semantics.trace import Trace as Trace
from plcopen_sfc.version import __version__ as __version__
