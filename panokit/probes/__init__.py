"""The probe library: light maps on disk, found again by what they are and where they are from.

probe       Probe, what the library knows of one map, and its id
traits      a map's kind, category, tags and sun, found when it is added
descriptors what light a map has, in a few numbers that no rotation changes
shelf       the folders: one per probe, whole or not there
entry       one line of the list, and which lines a filter lets pass
index       library.sqlite, which can be rebuilt from the folders at any time
library     `Library`: create, open, add, list, show, verify, reindex
selection   `select`: balanced, and as different as can be; its file
chain       from the capture to the probe, in words
exporting   `export_probes`: files for other tools, with credits
parquet     the index as a table
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.probes.chain import chain_lines
    from panokit.probes.descriptors import descriptor
    from panokit.probes.entry import Entry
    from panokit.probes.exporting import ExportResult, export_probes
    from panokit.probes.library import Added, Library, Verification
    from panokit.probes.probe import Probe, probe_id
    from panokit.probes.selection import Selection, read_selection, select, write_selection
    from panokit.probes.settings import AddSettings, ExportSettings, ProbeFilter, SelectSettings
    from panokit.probes.shelf import Problem

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "AddSettings": "panokit.probes.settings",
        "Added": "panokit.probes.library",
        "Entry": "panokit.probes.entry",
        "ExportResult": "panokit.probes.exporting",
        "ExportSettings": "panokit.probes.settings",
        "Library": "panokit.probes.library",
        "Probe": "panokit.probes.probe",
        "ProbeFilter": "panokit.probes.settings",
        "Problem": "panokit.probes.shelf",
        "SelectSettings": "panokit.probes.settings",
        "Selection": "panokit.probes.selection",
        "Verification": "panokit.probes.library",
        "chain_lines": "panokit.probes.chain",
        "descriptor": "panokit.probes.descriptors",
        "export_probes": "panokit.probes.exporting",
        "probe_id": "panokit.probes.probe",
        "read_selection": "panokit.probes.selection",
        "select": "panokit.probes.selection",
        "write_selection": "panokit.probes.selection",
    },
)
