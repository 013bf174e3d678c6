"""``plcopen-sfc simulate``: run a chart or a program, and show or save what it does."""

from __future__ import annotations

from dataclasses import replace

from plcopen_sfc.batch import functions_of
from plcopen_sfc.cli.command_files import load_input
from plcopen_sfc.cli.options import SimulateOptions
from plcopen_sfc.cli.screen import Screen, Table
from plcopen_sfc.errors import InputError, Location, SimulationError
from plcopen_sfc.files import refuse_unwritable, write_atomic
from plcopen_sfc.model.project import Project
from plcopen_sfc.semantics.inputs import CsvInputs, InputSource, RandomInputs
from plcopen_sfc.semantics.simulation import Simulation
from plcopen_sfc.semantics.subjects import resolve
from plcopen_sfc.semantics.trace import Trace

_DEFAULT_SCANS = 100
_FINDINGS = 1


def run(screen: Screen, file: str, how: SimulateOptions) -> int:
    """Run what is asked for; prints the scans in which something happens."""
    if how.inputs is not None and how.seed is not None:
        raise InputError("inputs come from a file or from chance, not from both", hint="Leave out --inputs or --seed.")
    project = load_input(screen, file, as_tool=how.as_tool)
    for wanted in how.written:
        refuse_unwritable(wanted)
    simulation = Simulation(
        resolve(project, how.pou),
        profile=how.profile,
        scan_time=how.scan_time,
        record=how.record or None,
        free_inputs=how.free or (),
        functions=functions_of(how.functions) if how.functions is not None else None,
    )
    for setting in how.settings or ():
        name, sign, value = setting.partition("=")
        if not sign:
            raise InputError(f"{setting!r} sets nothing", hint="Write it as NAME=VALUE.")
        simulation.set(name.strip(), value.strip())
    screen.note(f"rules: execution profile {simulation.profile.name}")
    failure = _drive(screen, simulation, how)
    trace = simulation.trace
    if screen.as_json or screen.report is not None:
        data = trace.as_dict() | {"file": file}
        screen.result(data | ({"error": str(failure)} if failure is not None else {}))
    if not screen.as_json:
        _show(screen, trace)
    _save(screen, how, trace, project)
    if failure is not None:
        screen.error(_in_file(failure, project))
        return _FINDINGS
    return 0


def _in_file(failure: SimulationError, project: Project) -> SimulationError:
    """Return an error with the place of its body in the file, as far as that is known."""
    place = failure.location
    (found,) = project.locations_of([f"POU {place.path}"]) if place.path and place.file is None else (Location(),)
    if found.line is not None:
        inside = f"{found.path} / line {place.line}" if place.line is not None else found.path
        failure.location = replace(found, path=inside)
    return failure


def _save(screen: Screen, how: SimulateOptions, trace: Trace, project: Project) -> None:
    if how.csv is not None:
        trace.save_csv(how.csv)
    if how.vcd is not None:
        trace.save_vcd(how.vcd)
    if how.svg is not None:
        write_atomic(how.svg, trace.to_svg().encode("ascii"))
    if how.html is not None:
        from plcopen_sfc.pages import page  # noqa: PLC0415  # brings the checks with it

        write_atomic(how.html, page(project, lang=how.lang, trace=trace).encode("ascii"))
    for path in how.written:
        screen.note(f"written: {path}")


def _drive(screen: Screen, simulation: Simulation, how: SimulateOptions) -> SimulationError | None:
    """Run all scans; the error that ends them, if one does."""
    source: InputSource | None = None
    if how.inputs is not None:
        source = CsvInputs.load(how.inputs)
    elif how.seed is not None:
        source = RandomInputs(how.seed, system_inputs=how.system_inputs)
    given = source.scans(simulation.scan_time) if source is not None else None
    scans = next((each for each in (how.scans, given) if each is not None), _DEFAULT_SCANS)
    inputs = source.bind(simulation.variables, simulation.scan_time) if source is not None else lambda _: {}
    if isinstance(source, CsvInputs) and source.ignored:
        screen.note(f"{how.inputs}: no inputs, so left out: {', '.join(source.ignored)}")
    for name, type_ in simulation.undeclared.items():
        screen.detail(f"{name} is not declared: an input of the type {type_}")
    try:
        simulation.run(inputs, scans)
    except SimulationError as error:
        return error
    return None


def _show(screen: Screen, trace: Trace) -> None:
    scans = trace.eventful_scans()
    changing = [index for index, column in enumerate(trace.columns) if screen.verbose or len(set(column)) > 1]
    first = len(trace.headers()) - len(trace.columns)
    kept = [*range(first), *(first + index for index in changing)]
    table = Table([trace.headers()[index] for index in kept])
    table.rows = [[row[index] for index in kept] for row in trace.rows(scans)]
    screen.table(table)
    still = [column for index, column in enumerate(trace.columns) if index not in changing]
    if still and len(trace):
        screen.note("unchanged: " + ", ".join(f"{column.name} = {column.signal.text(column[0])}" for column in still))
