"""The commands: functions that are given a screen and return the exit code.

`check`, `convert`, `diff`, `info`, `lower`, `simulate` and `validate` are commands of these names; `edits` (rename,
renumber, merge, apply, normalize), `drawings` (draw, page), `git_use` (git-setup, git-merge) and `catalogues` (formats,
rules) are several.
"""
