"""Objects as CODESYS V3 and TwinCAT 3 store them, for the formats of both.

* `object_elements`: POUs, types and lists of variables as elements; `object_lines`: their lines in the
  file, `object_identities`: their identities; `property_elements`: properties, which the model has as texts
* `archived_charts`: charts, which are archives of objects; steps with their entry, main and exit actions
* `chart_elements`: the elements of such a chart, declared once for both; `object_archive`: archives as such, and
  data that is nothing in the model
"""
