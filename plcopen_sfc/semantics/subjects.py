"""Subjects of a run: a chart, a POU or a project with a name, as a POU in its project."""

from __future__ import annotations

from dataclasses import dataclass

from plcopen_sfc.errors import ModelError, check_argument
from plcopen_sfc.model.body import Body, SfcBody
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork

__all__ = ["Subject", "resolve"]

_ALONE = "Chart"


@dataclass(frozen=True)
class Subject:
    """A POU and the project whose types, POUs and global variables it uses. `name`: ``Main``, ``Main.Fill``."""

    project: Project
    pou: Pou
    name: str


def resolve(subject: SfcNetwork | Pou | Project, pou: str | None = None, *, project: Project | None = None) -> Subject:
    """Find out what to run.

    Of a project, `pou` names it: ``Main``, or ``Main.Fill`` for an action; it may be left out where there
    is only one chart, or only one POU that can run. A chart brings the project that it is in; a chart of an action
    runs as if it were the body of its POU. A POU without `project` uses the project that it is in, if there is one.
    Raises `ModelError`.
    """
    check_argument(subject, (Project, Pou, SfcNetwork), "a chart, a POU or a project is needed")
    if isinstance(subject, Project):
        return _named(subject, pou) if pou is not None else _only(subject)
    if isinstance(subject, Pou):
        around = project or subject.project or Project(pous=[subject])
        return Subject(around, subject, subject.name)
    home = project or subject.project
    if home is None:
        alone = Pou(name=_ALONE, kind=PouKind.PROGRAM, bodies=[SfcBody(chart=subject)])
        return Subject(Project(pous=[alone]), alone, _ALONE)
    for name, owner, body in home.bodies():
        if isinstance(body, SfcBody) and body.chart is subject:
            return _of_body(home, name, owner, body)
    raise ModelError("this chart is inside another one", hint="Simulate the chart that it is a part of.")


def _named(project: Project, name: str) -> Subject:
    for path, owner, body in project.bodies():
        if isinstance(body, SfcBody) and path.casefold() == name.casefold():
            return _of_body(project, path, owner, body)
    for path, owner, body in project.bodies():
        if path.casefold() == name.casefold() and any(body is action.body for action in owner.actions):
            return _of_body(project, path, owner, body)
    found = project.pou(name)
    return Subject(project, found, found.name)


def _only(project: Project) -> Subject:
    charts = [(name, owner, body) for name, owner, body in project.bodies() if isinstance(body, SfcBody)]
    if len(charts) == 1:
        return _of_body(project, *charts[0])
    running = [pou for pou in project.pous if pou.kind is not PouKind.FUNCTION and pou.bodies]
    if not charts and len(running) == 1:
        return Subject(project, running[0], running[0].name)
    names = [name for name, _, _ in charts] or [pou.name for pou in running]
    if not names:
        raise ModelError("the project has nothing that could be run")
    raise ModelError("say which of its POUs to run", hint="There are: " + ", ".join(names[:20]))


def _of_body(project: Project, name: str, owner: Pou, body: Body) -> Subject:
    """An action runs as the body of a POU that is like its own in everything else."""
    if any(body is each for each in owner.bodies):
        return Subject(project, owner, owner.name)
    return Subject(project, owner.model_copy(update={"bodies": [body]}), name)
