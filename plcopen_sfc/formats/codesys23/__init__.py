"""CoDeSys 2.3 and TwinCAT 2: exports of projects and of single objects (``.EXP``), in their code pages.

`exp_outline` finds the objects of a file and their parts, `exp_reader` and `exp_codec` are the two ways between text
and model, `chart_text` has both for charts, `exp_language` puts program text into what the tool compiles. Comments of
this package hold what the text cannot express, see `plcopen_sfc.formats.remainder_comments`.
"""
