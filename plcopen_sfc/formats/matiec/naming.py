"""Names as matiec takes them: ASCII letters, digits and single underscores."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator

from plcopen_sfc.errors import ModelError
from plcopen_sfc.languages.words import IEC_KEYWORDS
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport, Outcome

_NAME = re.compile(r"(?!.*__)(?!.*_$)[A-Za-z_][A-Za-z0-9_]*")
_LETTERS = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue", "Ä": "Ae", "Ö": "Oe", "Ü": "Ue", "ß": "ss"})
_KEYWORDS = IEC_KEYWORDS | {"ON", "R_EDGE", "F_EDGE", "EN", "ENO"}


def give_plain_names(project: Project, report: ConversionReport) -> None:
    """Rename what has a name that matiec does not take; all references follow."""
    for path, name in list(_names(project)):
        if is_matiec_name(name):
            continue
        new = matiec_name(name)
        try:
            project.rename(path, new)
        except ModelError as error:
            report.add(Outcome.NOT_EXECUTED, "name", path, f"matiec does not take the name {name!r}: {error.message}")
        else:
            report.add(Outcome.TRANSLATED, "name", path, f"renamed to {new}: matiec does not take {name!r}")


def is_matiec_name(name: str) -> bool:
    """True if matiec takes `name` for a variable, a step or a POU."""
    return _NAME.fullmatch(name) is not None and name.upper() not in _KEYWORDS


def matiec_name(name: str) -> str:
    """A name near `name` that matiec takes."""
    plain = unicodedata.normalize("NFKD", name.translate(_LETTERS)).encode("ascii", "ignore").decode()
    plain = re.sub(r"_+", "_", re.sub(r"[^A-Za-z0-9_]", "_", plain)).rstrip("_") or "x"
    return plain if is_matiec_name(plain) else f"x_{plain.lstrip('_')}"


def _names(project: Project) -> Iterator[tuple[str, str]]:
    """Everything that a declaration or a chart names, innermost first: its path for `Project.rename` and its name."""
    for pou in project.pous:
        inner = [variable.name for variable in pou.variables()]
        inner += [action.name for action in pou.actions] + [transition.name for transition in pou.transitions]
        inner += [step.name for step in pou.sfc.steps] if pou.sfc is not None else []
        for name in inner:
            yield f"{pou.name}.{name}", name
    for pou in project.pous:
        yield pou.name, pou.name
    for declaration in project.data_types:
        for part in (*getattr(declaration.type, "members", []), *getattr(declaration.type, "values", [])):
            yield f"{declaration.name}.{part.name}", part.name
        yield declaration.name, declaration.name
    for section in project.global_variables:
        for variable in section.variables:
            yield (f"{section.name}.{variable.name}" if section.name else variable.name), variable.name
