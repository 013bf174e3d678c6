"""The typed model. Knows no file format, no XML and no I/O.

`plcopen_sfc.model.project.Project` is the root; `plcopen_sfc.model.sfc.SfcNetwork` is a chart.

* Projects: `project`, `pou`, `variables`, `types`, `body`, `network`, `dialect`; `declaration`, what of it has a name.
* Charts: `sfc`, `chart_settings`, `actions`, `conditions`, `times`; `drawing`, and `wiring`, the meaning of its wires;
  `exclusion`, of branches.
* Every object: `base`, `checked` (fields are checked), `owners` (what it is in), `text` (comments), `late` (read at the
  first access), `compare`, `numbering`.
"""

from __future__ import annotations

from plcopen_sfc.model.actions import (
    ActionEvent as ActionEvent,
    ActionKind as ActionKind,
    ForcedSituation as ForcedSituation,
    ForcingOrder as ForcingOrder,
    Monitoring as Monitoring,
    Qualifier as Qualifier,
    SymbolAccess as SymbolAccess,
)
from plcopen_sfc.model.base import (
    Element as Element,
    ExtensionData as ExtensionData,
    ForeignData as ForeignData,
    Model as Model,
    UnknownDataRule as UnknownDataRule,
)
from plcopen_sfc.model.body import (
    FbdBody as FbdBody,
    IlBody as IlBody,
    LdBody as LdBody,
    OpaqueBody as OpaqueBody,
    StBody as StBody,
)
from plcopen_sfc.model.chart_settings import (
    AlarmCategory as AlarmCategory,
    FlagUse as FlagUse,
    GraphSettings as GraphSettings,
    RuntimeLibrary as RuntimeLibrary,
    SfcFlag as SfcFlag,
    SfcSettings as SfcSettings,
)
from plcopen_sfc.model.conditions import (
    Expression as Expression,
    NamedCondition as NamedCondition,
    WiredCondition as WiredCondition,
)
from plcopen_sfc.model.dialect import Dialect as Dialect
from plcopen_sfc.model.drawing import (
    ActionEntry as ActionEntry,
    Drawing as Drawing,
    Places as Places,
    StepActionKind as StepActionKind,
    Symbol as Symbol,
    SymbolKind as SymbolKind,
)
from plcopen_sfc.model.network import (
    Block as Block,
    BlockCall as BlockCall,
    BlockParameters as BlockParameters,
    BlockVariable as BlockVariable,
    Coil as Coil,
    CommentBox as CommentBox,
    Connection as Connection,
    Connector as Connector,
    Contact as Contact,
    Continuation as Continuation,
    Edge as Edge,
    ErrorBox as ErrorBox,
    InOutVariable as InOutVariable,
    InputPin as InputPin,
    InputVariable as InputVariable,
    Jump as Jump,
    Label as Label,
    LeftPowerRail as LeftPowerRail,
    LogicNetwork as LogicNetwork,
    Node as Node,
    OutputPin as OutputPin,
    OutputVariable as OutputVariable,
    Return as Return,
    RightPowerRail as RightPowerRail,
    Storage as Storage,
    VendorElement as VendorElement,
)
from plcopen_sfc.model.pou import (
    Action as Action,
    DataBlock as DataBlock,
    DataBlockKind as DataBlockKind,
    Method as Method,
    NamedTransition as NamedTransition,
    Pou as Pou,
    PouKind as PouKind,
)
from plcopen_sfc.model.project import (
    Chart as Chart,
    Configuration as Configuration,
    DrawingScales as DrawingScales,
    FileHeader as FileHeader,
    ForeignDataInfo as ForeignDataInfo,
    PouInstance as PouInstance,
    Project as Project,
    Resource as Resource,
    Scaling as Scaling,
    Tag as Tag,
    TagTable as TagTable,
    Task as Task,
    TaskSettings as TaskSettings,
    TaskWatchdog as TaskWatchdog,
    TreeNode as TreeNode,
)
from plcopen_sfc.model.sfc import (
    ActionAssociation as ActionAssociation,
    Body as Body,
    BodyCondition as BodyCondition,
    Condition as Condition,
    Enclosure as Enclosure,
    Macro as Macro,
    PartialChart as PartialChart,
    PartialChartKind as PartialChartKind,
    PermanentOperation as PermanentOperation,
    Sequence as Sequence,
    SfcBody as SfcBody,
    SfcNetwork as SfcNetwork,
    Step as Step,
    Supervised as Supervised,
    Transition as Transition,
)
from plcopen_sfc.model.text import (
    MarkupText as MarkupText,
    MultilingualText as MultilingualText,
    Text as Text,
    plain as plain,
)
from plcopen_sfc.model.types import (
    ArrayType as ArrayType,
    ArrayValue as ArrayValue,
    DataType as DataType,
    DataTypeDeclaration as DataTypeDeclaration,
    DerivedType as DerivedType,
    Dimension as Dimension,
    Elementary as Elementary,
    ElementaryType as ElementaryType,
    EnumType as EnumType,
    EnumValue as EnumValue,
    MemberValue as MemberValue,
    PointerType as PointerType,
    RepeatedValue as RepeatedValue,
    SimpleValue as SimpleValue,
    StringType as StringType,
    StructType as StructType,
    StructValue as StructValue,
    SubrangeType as SubrangeType,
    Value as Value,
    Variable as Variable,
)
from plcopen_sfc.model.variables import (
    AccessDirection as AccessDirection,
    AccessSection as AccessSection,
    AccessVariable as AccessVariable,
    ConfigSection as ConfigSection,
    ConfigVariable as ConfigVariable,
    Interface as Interface,
    SectionKind as SectionKind,
    VariableSection as VariableSection,
)
