"""The probe library: light maps on disk, found again by what they are and where they are from.

probe    Probe, what the library knows of one map, and its id
shelf    the folders: one per probe, whole or not there
index    library.sqlite, which can be rebuilt from the folders at any time
library  `Library`: create, open, add, list, show, verify, reindex
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.probes.index import Entry, ProbeFilter
    from panokit.probes.library import Added, Library, Verification
    from panokit.probes.probe import Probe, probe_id
    from panokit.probes.shelf import Problem

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "Added": "panokit.probes.library",
        "Entry": "panokit.probes.index",
        "Library": "panokit.probes.library",
        "Probe": "panokit.probes.probe",
        "ProbeFilter": "panokit.probes.index",
        "Problem": "panokit.probes.shelf",
        "Verification": "panokit.probes.library",
        "probe_id": "panokit.probes.probe",
    },
)
