"""From the model to the text of declarations; `declaration_reading` is the way back.

Text cannot express some things (a comment in two languages, an invalid name), which are left out or changed: a
caller that must not lose it reads the text back and compares.
"""

from __future__ import annotations

from plcopen_sfc.languages.declarations.declaration_comments import comment_lines, write_attributes
from plcopen_sfc.languages.declarations.kept_texts import kept
from plcopen_sfc.languages.declarations.type_names import (
    SECTION_KEYWORDS,
    declared_name,
    is_quoted_in_scl,
    written_elementary,
    written_name,
)
from plcopen_sfc.languages.st.parsing import parse_declarations, parse_expression
from plcopen_sfc.languages.st.printing import INDENT
from plcopen_sfc.model import types as t
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.text import Text, plain
from plcopen_sfc.model.variables import AccessDirection, AccessSection, AccessVariable, ConfigSection, VariableSection


def indent_of(dialect: Dialect) -> str:
    """Return the indentation of a level of declarations: TIA Portal takes three spaces."""
    return "   " if dialect is Dialect.SCL else INDENT


# -- types


def write_type(type_: t.DataType, dialect: Dialect = Dialect.IEC, indent: str = "") -> str:
    """Return a type. One of several lines has `indent` before all but the first."""
    scl = dialect is Dialect.SCL
    match type_:
        case t.ElementaryType(name=name):
            return written_elementary(name, dialect)
        case t.StringType(wide=wide, length=length):
            word = ("WString" if wide else "String") if scl else ("WSTRING" if wide else "STRING")
            return word + _length(length, dialect)
        case t.DerivedType():
            return _derived(type_, dialect)
        case t.ArrayType(dimensions=dimensions, base=base):
            bounds = ", ".join(_dimension(dimension, dialect) for dimension in dimensions)
            inner = write_type(base, dialect, indent)
            return f"Array[{bounds}] of {inner}" if scl else f"ARRAY [{bounds}] OF {inner}"
        case t.PointerType(base=base, reference=reference):
            word = "REFERENCE TO" if dialect in _CODESYS else "REF_TO"
            return f"{word if reference else 'POINTER TO'} {write_type(base, dialect, indent)}"
        case t.SubrangeType(bounds=bounds, base=base):
            dimension = _dimension(bounds, dialect)
            return f"{write_type(base, dialect)} ({dimension})"
        case t.EnumType():
            return _enum(type_, dialect)
        case t.StructType():
            return _struct(type_, dialect, indent)


_CODESYS = (Dialect.CODESYS, Dialect.TWINCAT)


def _length(length: str | None, dialect: Dialect) -> str:
    if length is None:
        return ""
    text = _expression(length, dialect) or "1"
    return f"({text})" if dialect in _CODESYS else f"[{text}]"


def _derived(type_: t.DerivedType, dialect: Dialect) -> str:
    texts = kept(type_.extension_data)
    quoted = "quoted" in texts or (is_quoted_in_scl(type_.name) and "unquoted" not in texts)
    if dialect is Dialect.SCL and quoted:
        name = '"' + type_.name.replace('"', "_") + '"'
    else:
        name = ".".join(written_name(part, dialect) for part in type_.name.split("."))
    text = name + texts.get("constructor", "")
    return text if _parses(f"VAR x : {text}; END_VAR", dialect) else name


def _dimension(dimension: t.Dimension, dialect: Dialect) -> str:
    if dimension.lower == dimension.upper == "*":
        return "*"
    return f"{_expression(dimension.lower, dialect) or '0'}..{_expression(dimension.upper, dialect) or '0'}"


def _enum(type_: t.EnumType, dialect: Dialect) -> str:
    values = ", ".join(_enum_value(value, dialect) for value in type_.values)
    base = write_type(type_.base, dialect) if type_.base is not None else ""
    if dialect in _CODESYS:
        return f"({values}) {base}".rstrip()
    return f"{base} ({values})".lstrip()


def _enum_value(value: t.EnumValue, dialect: Dialect) -> str:
    name = written_name(value.name, dialect)
    number = _expression(value.value, dialect) if value.value is not None else None
    return f"{name} := {number}" if number else name


def _struct(type_: t.StructType, dialect: Dialect, indent: str) -> str:
    texts = kept(type_.extension_data)
    word = "Struct" if dialect is Dialect.SCL else "UNION" if "union" in texts else "STRUCT"
    deeper = indent + indent_of(dialect)
    lines = [write_variable(member, dialect, deeper) for member in type_.members]
    lines += [*_closing(texts, deeper), *_unread(texts, deeper)]
    lines += [deeper + line for line in _comment(type_.comment, dialect)]
    return "\n".join([word, *lines, f"{indent}END_{word.upper()}"])


# -- values


def write_value(value: t.Value, dialect: Dialect = Dialect.IEC) -> str:
    """Return an initial value; empty if there is none, or none that could be read back."""
    text = _value(value)
    return text if text and _parses(f"VAR x : INT := {text}; END_VAR", dialect) else ""


def _initial(value: t.Value | None, dialect: Dialect) -> str:
    """Return what gives something its initial value; empty where it has none that could be read back."""
    text = write_value(value, dialect) if value is not None else ""
    return f" := {text}" if text else ""


def _value(value: t.Value) -> str:
    match value:
        case t.SimpleValue(text=text):
            return text or ""
        case t.ArrayValue(items=items):
            return "[" + ", ".join(map(_repeated, items)) + "]"
        case t.StructValue(members=members):
            return "(" + ", ".join(f"{m.member} := {_value(m.value)}" for m in members) + ")"


def _repeated(item: t.RepeatedValue) -> str:
    value = _value(item.value)
    return value if item.repetitions is None else f"{item.repetitions}({value})"


def _expression(text: str, dialect: Dialect) -> str | None:
    """`text` if it is an expression."""
    return text if text.strip() and not parse_expression(text, dialect).problems else None


def _parses(text: str, dialect: Dialect) -> bool:
    return not parse_declarations(text, dialect).problems


# -- variables and sections


def write_variable(variable: t.Variable, dialect: Dialect = Dialect.IEC, indent: str = "") -> str:
    """Return the lines of a variable: a short comment is behind it, a longer one before it."""
    texts = kept(variable.extension_data)
    scl = dialect is Dialect.SCL
    attributes = _attributes(variable, texts) if scl else ""
    name = declared_name(variable.name, dialect) if variable.name or variable.address is None else ""
    address = f" AT {_address(variable.address, dialect)}" if variable.address is not None else ""
    edge = f" {texts['edge']}" if "edge" in texts else ""
    text = f"{name}{attributes}{address} : {write_type(variable.type, dialect, indent)}{edge}".lstrip()
    text += f"{_initial(variable.initial, dialect)};"
    return _with_comment(variable.comment, text, dialect, indent, [] if scl else _pragmas(texts, dialect))


def _attributes(variable: t.Variable, texts: dict[str, str]) -> str:
    written = [write_attributes(variable.attributes)] if variable.attributes else []
    return "".join(f" {text}" for text in [*written, *texts.get("attributes", "").splitlines()])


def _address(address: str, dialect: Dialect) -> str:
    text = written_name(address, dialect) if dialect is Dialect.SCL and not address.startswith("%") else address
    return text if _parses(f"VAR x AT {text} : INT; END_VAR", dialect) else "%I*"


def _pragmas(texts: dict[str, str], dialect: Dialect) -> list[str]:
    """Return the pragmas before a declaration, a line each."""
    return texts.get("attributes" if dialect is Dialect.SCL else "pragmas", "").splitlines()


def _with_comment(comment: Text | None, text: str, dialect: Dialect, indent: str, pragmas: list[str]) -> str:
    lines = _comment(comment, dialect)
    above = [indent + line for line in pragmas]
    if len(lines) == 1 and "\n" not in text:
        return "\n".join([*above, f"{indent}{text} {lines[0]}"])
    return "\n".join([*(indent + line for line in lines), *above, indent + text])


def _comment(comment: Text | None, dialect: Dialect) -> list[str]:
    text = plain(comment)
    return comment_lines(text, dialect) if text else []


def write_section(section: VariableSection, dialect: Dialect = Dialect.IEC, indent: str = "") -> str:
    """``VAR .. END_VAR`` with a comment before it."""
    deeper = indent + indent_of(dialect)
    lines = [indent + line for line in section_head(section, dialect)]
    lines += [write_variable(variable, dialect, deeper) for variable in section.variables]
    rest = [*section_closing(section, deeper), *section_rest(section, deeper)]
    return "\n".join([*lines, *rest, f"{indent}END_VAR"])


def section_head(section: VariableSection, dialect: Dialect) -> list[str]:
    """Return the lines before the variables of a section."""
    texts = kept(section.extension_data)
    word = texts.get("keyword", "")
    words = [word if word.startswith("VAR") else SECTION_KEYWORDS[section.kind]]
    constant = section.constant or section.kind.value == "constant"
    words += ["CONSTANT"] * constant + ["RETAIN"] * section.retain + ["NON_RETAIN"] * section.nonretain
    words += ["PERSISTENT"] * section.persistent + texts.get("qualifiers", "").split()
    return [*_comment(section.comment, dialect), *_pragmas(texts, dialect), " ".join(words)]


def section_closing(section: VariableSection | t.StructType, indent: str) -> list[str]:
    """Return the lines of the pragmas behind the last variable of a section or a structure."""
    return _closing(kept(section.extension_data), indent)


def section_rest(section: VariableSection, indent: str) -> list[str]:
    """Return the lines before the end of a section: what did not parse when it was read."""
    return _unread(kept(section.extension_data), indent)


def _closing(texts: dict[str, str], indent: str) -> list[str]:
    return [indent + line for line in texts.get("closing", "").splitlines()]


def _unread(texts: dict[str, str], indent: str) -> list[str]:
    unreadable = texts.get("unreadable", "")
    return [indent + unreadable] if unreadable else []


def write_listing(section: AccessSection | ConfigSection, dialect: Dialect = Dialect.IEC, indent: str = "") -> str:
    """``VAR_ACCESS .. END_VAR`` or ``VAR_CONFIG .. END_VAR``."""
    deeper = indent + indent_of(dialect)
    lines = [f"{indent}{'VAR_ACCESS' if isinstance(section, AccessSection) else 'VAR_CONFIG'}"]
    for variable in section.variables:
        if isinstance(variable, AccessVariable):
            direction = f" {_DIRECTIONS[variable.direction]}" if variable.direction is not None else ""
            alias, type_ = written_name(variable.alias, dialect), write_type(variable.type)
            text = f"{alias} : {variable.path} : {type_}{direction};"
        else:
            address = f" AT {variable.address}" if variable.address is not None else ""
            type_ = write_type(variable.type, dialect, deeper)
            text = f"{variable.path}{address} : {type_}{_initial(variable.initial, dialect)};"
        lines.append(_with_comment(variable.comment, text, dialect, deeper, []))
    return "\n".join([*lines, *_unread(kept(section.extension_data), deeper), f"{indent}END_VAR"])


_DIRECTIONS = {AccessDirection.READ_ONLY: "READ_ONLY", AccessDirection.READ_WRITE: "READ_WRITE"}


# -- declarations of types


def write_data_type(declaration: t.DataTypeDeclaration, dialect: Dialect = Dialect.IEC, indent: str = "") -> str:
    """``TYPE name : type := initial; END_TYPE``, in SCL ``TYPE "name" STRUCT .. END_STRUCT; END_TYPE``."""
    texts = kept(declaration.extension_data)
    lines = [indent + line for line in _comment(declaration.comment, dialect)]
    if dialect is Dialect.SCL:
        return "\n".join([*lines, *_scl_type(declaration, texts, indent)])
    lines += [indent + line for line in _pragmas(texts, dialect)]
    extends = f" EXTENDS {texts['extends']}" if "extends" in texts else ""
    deeper = indent + indent_of(dialect)
    text = f"{deeper}{written_name(declaration.name, dialect)}{extends} : "
    text += f"{write_type(declaration.type, dialect, deeper)}{_initial(declaration.initial, dialect)};"
    return "\n".join([*lines, f"{indent}TYPE", text, f"{indent}END_TYPE"])


def _scl_type(declaration: t.DataTypeDeclaration, texts: dict[str, str], indent: str) -> list[str]:
    deeper = indent + indent_of(Dialect.SCL)
    head = [f'{indent}TYPE "{declaration.name}"', *_pragmas(texts, Dialect.SCL)]
    head += [indent + line for line in texts.get("properties", "").splitlines()]
    return [*head, f"{deeper}{write_type(declaration.type, Dialect.SCL, deeper)};", f"{indent}END_TYPE"]
