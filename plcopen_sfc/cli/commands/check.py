"""``plcopen-sfc check``: what the numbered rules find in the charts of files.

The table ``[tool.plcopen_sfc]`` of the nearest pyproject.toml has options for the files of a folder.
"""

from __future__ import annotations

import tomllib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path, PurePath, PurePosixPath
from typing import Any
from urllib.parse import quote

from plcopen_sfc.analysis.checks import Rule, all_rules
from plcopen_sfc.checking import check
from plcopen_sfc.cli.command_files import finding_data, load_input
from plcopen_sfc.cli.many_files import ManyFiles, for_each
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location, ModelError, SfcError
from plcopen_sfc.files import file_exists, folder_exists, read_bytes
from plcopen_sfc.version import __version__
from plcopen_sfc.whole_numbers import counted

_FILE = "pyproject.toml"
_TABLE = "plcopen_sfc"


class ConfigurationError(SfcError):
    """A configuration file that cannot be read, or with a key or value that is unknown."""


@dataclass(frozen=True)
class CheckOptions:
    """Options of the command, or those that a table has: None for the others. `path`: the file of the table."""

    select: Sequence[str] | None = None
    ignore: Sequence[str] | None = None
    profile: str | None = None
    fail_on: str | None = None
    form: str = "text"
    externals: tuple[str, ...] = ()
    path: str | None = None


class Configurations:
    """The configuration for each file: that of its folder or of the nearest one above that has the table."""

    def __init__(self) -> None:
        self._of_folder: dict[Path, CheckOptions] = {}

    def of(self, file: str) -> CheckOptions:
        """Return the configuration for a file or folder. Raises `ConfigurationError`."""
        path = Path(file).absolute()
        return self._of(path if folder_exists(path) else path.parent)

    def _of(self, folder: Path) -> CheckOptions:
        found = self._of_folder.get(folder)
        if found is None:
            found = _read(folder / _FILE)
            if found is None:
                found = self._of(folder.parent) if folder.parent != folder else CheckOptions()
            self._of_folder[folder] = found
        return found


def _read(path: Path) -> CheckOptions | None:
    """Return the table in this file; None where there is no file or no table."""
    if not file_exists(path):
        return None
    try:
        content = tomllib.loads(read_bytes(path).decode("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ConfigurationError(f"this is no TOML: {error}", location=Location(str(path))) from None
    tools = content.get("tool")
    table = tools.get(_TABLE) if isinstance(tools, dict) else None
    if table is None:
        return None
    if not isinstance(table, dict):
        raise _wrong(path, _TABLE, "a table")
    return _checked(path, table)


def _checked(path: Path, table: Mapping[str, Any]) -> CheckOptions:
    known = {
        "select": "a list of codes",
        "ignore": "a list of codes",
        "profile": "a text",
        "fail-on": "a text",
        "externals": "a list of names",
    }
    for key, value in table.items():
        if key not in known:
            hint = "Known are: " + ", ".join(known)
            raise ConfigurationError(
                f"[tool.{_TABLE}] has an unknown key {key!r}", location=Location(str(path)), hint=hint
            )
        listed = known[key].startswith("a list")
        fits = isinstance(value, list) and all(isinstance(i, str) for i in value) if listed else isinstance(value, str)
        if not fits:
            raise _wrong(path, key, known[key])
    given: dict[str, Any] = {
        key.replace("-", "_"): tuple(each) if isinstance(each, list) else each for key, each in table.items()
    }
    return CheckOptions(path=str(path), **given)


def _wrong(path: Path, key: str, wanted: str) -> ConfigurationError:
    return ConfigurationError(f"{key!r} of [tool.{_TABLE}] is not {wanted}", location=Location(str(path)))


_SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"
_LEVELS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "note"}


def sarif(findings: Sequence[Diagnostic], errors: Iterable[SfcError] = ()) -> dict[str, Any]:
    """Return one run of `check` as a SARIF log. `errors` are those of files that could not be read."""
    places = {rule.code: index for index, rule in enumerate(all_rules())}
    notifications = [_notification(error) for error in errors]
    invocation: dict[str, Any] = {"executionSuccessful": not notifications}
    if notifications:
        invocation["toolExecutionNotifications"] = notifications
    run = {
        "tool": {
            "driver": {
                "name": "plcopen-sfc",
                "version": __version__,
                "rules": [_rule(rule) for rule in all_rules()],
            }
        },
        "invocations": [invocation],
        "columnKind": "unicodeCodePoints",
        "results": [_result(finding, places) for finding in findings],
    }
    return {"$schema": _SCHEMA, "version": "2.1.0", "runs": [run]}


def _rule(rule: Rule) -> dict[str, Any]:
    level = _LEVELS[rule.severity] if rule.severity is not None else "none"
    return {
        "id": rule.code,
        "shortDescription": {"text": rule.title},
        "fullDescription": {"text": rule.why},
        "help": {"text": rule.hints},
        "defaultConfiguration": {"level": level},
    }


def _result(finding: Diagnostic, places: dict[str, int]) -> dict[str, Any]:
    text = f"{finding.message}. {finding.hint}".strip() if finding.hint else finding.message
    result: dict[str, Any] = {
        "ruleId": finding.code,
        "ruleIndex": places[finding.code],
        "level": _LEVELS[finding.severity],
        "message": {"text": text},
    }
    locations = _locations(finding.location)
    if finding.location.path:  # the same finding after an edit that moves it to another line
        what = f"{finding.code} {finding.location.path}"
        result["partialFingerprints"] = {"objectPath/v1": sha256(what.encode()).hexdigest()}
    return result | ({"locations": locations} if locations else {})


_COMMANDS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "notice"}
"""Words of GitHub for severities."""


def github_annotations(findings: Sequence[Diagnostic], errors: Iterable[SfcError] = ()) -> Iterator[str]:
    """Yield workflow commands of GitHub Actions, which shows each finding beside its line of the file."""
    for found in findings:
        where = f"{found.location.path}: " if found.location.path else ""
        text = f"{where}{found.message}" + (f"\n{found.hint}" if found.hint else "")
        yield _annotation(_COMMANDS[found.severity], found.location, found.code, text)
    for error in errors:
        yield _annotation("error", error.location, "cannot be read", error.message)


def _annotation(word: str, location: Location, title: str, text: str) -> str:
    fields = {"file": location.file, "line": location.line, "col": location.column, "title": title}
    listed = ",".join(
        f"{name}={_escaped(str(value)).replace(':', '%3A').replace(',', '%2C')}"
        for name, value in fields.items()
        if value is not None
    )
    return f"::{word} {listed}::{_escaped(text)}"


def _escaped(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _notification(error: SfcError) -> dict[str, Any]:
    notification: dict[str, Any] = {"level": "error", "message": {"text": error.message}}
    locations = _locations(error.location)
    return notification | ({"locations": locations} if locations else {})


def _locations(location: Location) -> list[dict[str, Any]]:
    found: dict[str, Any] = {}
    if location.file:
        physical: dict[str, Any] = {"artifactLocation": {"uri": _uri(location.file)}}
        if location.line is not None:
            region = {"startLine": location.line}
            if location.column is not None:
                region["startColumn"] = location.column
            physical["region"] = region
        found["physicalLocation"] = physical
    if location.path:
        found["logicalLocations"] = [{"fullyQualifiedName": location.path}]
    return [found] if found else []


def _uri(file: str) -> str:
    """Return a relative path as a relative reference, an absolute one as a file URI (RFC 3986)."""
    path = PurePath(file)
    if path.is_absolute():
        return path.as_uri()
    return quote(str(PurePosixPath(*path.parts)))


_FINDINGS = 1
_ORDER = {Severity.INFO: 0, Severity.WARNING: 1, Severity.ERROR: 2}
_SAID_BY_RULES = frozenset({"SFC103", "SFC104", "SFC106", "SFC109", "SFC110", "SFC111", "SFC112"})
"""Findings of readers that a rule reports too."""

FORMATS = ("text", "json", "sarif", "github")
FAIL_ON = ("error", "warning", "info", "never")


def _codes(texts: Sequence[str] | None) -> tuple[str, ...] | None:
    """Codes that were given in several options, or in one with commas between."""
    if not texts:
        return None
    found = tuple(code for text in texts for code in (part.strip() for part in text.split(",")) if code)
    return found or ("",)  # nothing at all is no code, and not the same as no option


def run(screen: Screen, files: ManyFiles, how: CheckOptions) -> int:
    """Print the findings of all files."""
    how = replace(
        how, select=_codes(how.select), ignore=_codes(how.ignore), form="json" if screen.as_json else how.form
    )
    screen.as_json = how.form != "text"
    _validate(how)
    configurations = Configurations()
    wanted = {name: _with(how, configurations.of(name)) for name in files.found}
    outcomes = for_each(screen, wanted, _check, "Checking", jobs=files.jobs)
    everything = [finding for each in outcomes if each.value is not None for finding in each.value]
    errors = [each.error for each in outcomes if each.error is not None]
    if how.form == "github":
        screen.as_json = False
        for line in github_annotations(everything, errors):
            screen.line(line)
    if how.form == "sarif":
        screen.json(sarif(everything, errors))
        screen.as_json = False
    listed = (replace(each, value=_data(each.path, each.value)) if each.error is None else each for each in outcomes)
    screen.result({"files": [each.as_dict() for each in listed]})
    return screen.exit_code


def _check(screen: Screen, name: str, wanted: CheckOptions) -> list[Diagnostic]:
    project = load_input(screen, name)
    read = project.diagnostics  # reads the charts, too, before anything is printed of them
    found = check(
        project,
        profile=wanted.profile,
        select=wanted.select or (),
        ignore=wanted.ignore or (),
        externals=wanted.externals,
    )
    others = [finding for finding in read if finding.code not in _SAID_BY_RULES]
    screen.exit_code = max(screen.exit_code, _exit_code(found, others, wanted.fail_on or "warning"))
    for finding in others:
        screen.finding(finding, result=False)
    if wanted.form == "text":
        _print(screen, name, found)
    return found


def _data(name: str, found: list[Diagnostic]) -> dict[str, Any]:
    return {"file": name, "findings": [finding_data(finding) for finding in found]}


def _validate(how: CheckOptions) -> None:
    """Refuse what is unknown before any file is read. Raises `ModelError`."""
    from plcopen_sfc.analysis.checks import all_rules  # noqa: PLC0415  # brings the parser with it
    from plcopen_sfc.analysis.checks.rule_table import known  # noqa: PLC0415
    from plcopen_sfc.semantics.profile import profile  # noqa: PLC0415

    known(all_rules(), (*(how.select or ()), *(how.ignore or ())))
    if how.profile is not None:
        profile(how.profile)
    if how.fail_on is not None and how.fail_on not in FAIL_ON:
        raise ModelError(f"there is no severity {how.fail_on!r}", hint=f"There are: {', '.join(FAIL_ON)}")
    if how.form not in FORMATS:
        raise ModelError(f"there is no format {how.form!r} of results", hint=f"There are: {', '.join(FORMATS)}")


def _with(how: CheckOptions, configuration: CheckOptions) -> CheckOptions:
    """Return the options, completed by the configuration."""
    try:
        _validate(configuration)
    except ModelError as error:
        raise ModelError(error.message, location=Location(configuration.path), hint=error.hint) from None
    given = {name: each for name, each in vars(how).items() if each is not None and name != "externals"}
    return replace(configuration, **given)


def _exit_code(found: Sequence[Diagnostic], others: Sequence[Diagnostic], fail_on: str) -> int:
    if fail_on == "never":
        return 0
    least = _ORDER[Severity(fail_on)]
    wrong = any(_ORDER[finding.severity] >= least for finding in found)
    return _FINDINGS if wrong or any(finding.severity is Severity.ERROR for finding in others) else 0


def _print(screen: Screen, name: str, found: list[Diagnostic]) -> None:
    for finding in found:
        screen.finding(finding, result=True)
        if finding.hint and not screen.quiet:
            screen.line((f"  {finding.hint}", "dim"))
    if screen.quiet:
        return
    counts = Counter(finding.severity.value for finding in found)
    what = ", ".join(counted(count, severity) for severity, count in counts.items())
    worst = "bold red" if counts["error"] else "yellow" if counts["warning"] else "green"
    screen.line((f"{name}: ", "bold"), (what or "nothing found", worst))
