"""PLCopen TC6 XML, and what CODESYS shares with it.

Public: `tc6_codec.CODEC`, `tc6_versions.validate_tc6`.

* `tc6_versions`: versions of TC6 XML, recognised and validated. `tc6_reading`, `tc6_writing`: common parts of readers
  and writers, extension data among them.
* `tc6_codec`: the entry in the table of formats, and whole projects. Elements, read and written: `tc6_configurations`,
  `tc6_declarations`, `tc6_bodies` (POUs too), `tc6_networks`, `tc6_pins`. Charts: `tc6_charts` and
  `tc6_chart_meaning` (read), `tc6_chart_writer`.
* Charts that `conversion.adaptation` wrote in other terms keep those of the source beside them: `source_marks`.
"""
