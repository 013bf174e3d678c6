"""Differences between two projects in the words of an engineer: what was changed, renamed, moved, added or removed.

`changes`             the result: changes, and what they do to the behaviour
`renamings`           recognises what has another name
`tree_comparison`     compares two listings of `plcopen_sfc.conversion`
`project_comparison`  compares two projects (`diff`), and runs the changed charts against each other
`merged_files`        tells what a merge of lines has made that neither side wants
"""

from plcopen_sfc.comparison.changes import Change, ChangeKind, ProjectDiff, Proof
from plcopen_sfc.comparison.project_comparison import diff

__all__ = ["Change", "ChangeKind", "ProjectDiff", "Proof", "diff"]
