"""The public names of the package and where they are: the one list, which `__init__.py` and type checkers read."""

from plcopen_sfc.analysis.equivalence import equivalent as equivalent
from plcopen_sfc.analysis.verdict import (
    UntestedError as UntestedError,
    Verdict as Verdict,
    VerdictKind as VerdictKind,
)
from plcopen_sfc.api import (
    check_import as check_import,
    check_syntax as check_syntax,
    convert as convert,
    dumps as dumps,
    load as load,
    loads as loads,
    save as save,
)
from plcopen_sfc.checking import check as check
from plcopen_sfc.comparison import (
    Change as Change,
    ChangeKind as ChangeKind,
    ProjectDiff as ProjectDiff,
    Proof as Proof,
    diff as diff,
)
from plcopen_sfc.diagnostics import (
    DamagedSourceError as DamagedSourceError,
    Diagnostic as Diagnostic,
    Severity as Severity,
)
from plcopen_sfc.documents.list_merging import merge_list as merge_list
from plcopen_sfc.documents.lowered import (
    LoweredFile as LoweredFile,
    lower_to_file as lower_to_file,
)
from plcopen_sfc.documents.picture_files import (
    PictureFile as PictureFile,
    draw as draw,
)
from plcopen_sfc.errors import (
    ArgumentError as ArgumentError,
    ExhaustionError as ExhaustionError,
    FileAccessError as FileAccessError,
    FormatError as FormatError,
    InputError as InputError,
    Location as Location,
    ComparisonInterrupt as ComparisonInterrupt,
    LossError as LossError,
    LoweringError as LoweringError,
    ModelError as ModelError,
    OldVersionError as OldVersionError,
    PluginError as PluginError,
    ScriptError as ScriptError,
    SfcError as SfcError,
    SimulationError as SimulationError,
)
from plcopen_sfc.lowering import (
    LoweredPou as LoweredPou,
    lower as lower,
)
from plcopen_sfc.model import (
    Action as Action,
    ActionAssociation as ActionAssociation,
    ActionEvent as ActionEvent,
    ActionKind as ActionKind,
    Dialect as Dialect,
    Expression as Expression,
    Interface as Interface,
    Pou as Pou,
    PouKind as PouKind,
    Project as Project,
    Qualifier as Qualifier,
    SectionKind as SectionKind,
    SfcBody as SfcBody,
    SfcNetwork as SfcNetwork,
    StBody as StBody,
    Step as Step,
    Supervised as Supervised,
    Transition as Transition,
    Variable as Variable,
    VariableSection as VariableSection,
)
from plcopen_sfc.pages import (
    conversion_page as conversion_page,
    diff_page as diff_page,
    page as page,
)
from plcopen_sfc.refactor.builder import (
    jump as jump,
    selection as selection,
    simultaneous as simultaneous,
    step as step,
    transition as transition,
)
from plcopen_sfc.refactor.editor import Editor as Editor
from plcopen_sfc.report import (
    ConversionReport as ConversionReport,
    Converted as Converted,
    Outcome as Outcome,
)
from plcopen_sfc.semantics.inputs import (
    CsvInputs as CsvInputs,
    RandomInputs as RandomInputs,
)
from plcopen_sfc.semantics.simulation import simulate as simulate
from plcopen_sfc.semantics.trace import Trace as Trace
from plcopen_sfc.version import __version__ as __version__
