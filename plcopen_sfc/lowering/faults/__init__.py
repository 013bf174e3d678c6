"""Faults of textbook sequences; `fault_kinds` has what users see, the others are internal.

`fault_kinds`       the faults, and how a report describes them
`fault_detection`   the faults that single scans show
`fault_search`      the search for the shortest inputs that show one
"""
