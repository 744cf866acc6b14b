"""Set against set: an augmented set of maps beside a reference set.

settings      the rule's numbers
members       the maps of a set, and which of them show one place
measured      a map at the common size, its lights and harmonics
descriptors   what a map's light is like, in figures without scale
classes       sun, overcast, night or indoor, from the light alone
store         descriptions kept by content
resampling    shuffled labels and bootstraps over places
distances     one figure in two sets
changes       what is added and what is distorted, by a rule
multivariate  all figures at once
nearest       the nearest reference of each map
duplicates    maps that show the same thing
places        where and when
coverage      what of the reference is reached
comparing     `compare_sets`: all of it
showing       the sections of a report; showing_changes the table of figures
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.qa.sets.changes import Change, Effect
    from panokit.qa.sets.classes import LightClass, light_class
    from panokit.qa.sets.comparing import SetComparison, compare_sets
    from panokit.qa.sets.descriptors import DESCRIPTORS, describe
    from panokit.qa.sets.duplicates import NearDuplicate, find_near_duplicates
    from panokit.qa.sets.measured import measure
    from panokit.qa.sets.members import Member, members_of
    from panokit.qa.sets.settings import SetSettings
    from panokit.qa.sets.store import Description, DescriptionStore

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "Change": "panokit.qa.sets.changes",
        "DESCRIPTORS": "panokit.qa.sets.descriptors",
        "Description": "panokit.qa.sets.store",
        "DescriptionStore": "panokit.qa.sets.store",
        "Effect": "panokit.qa.sets.changes",
        "LightClass": "panokit.qa.sets.classes",
        "Member": "panokit.qa.sets.members",
        "NearDuplicate": "panokit.qa.sets.duplicates",
        "SetComparison": "panokit.qa.sets.comparing",
        "SetSettings": "panokit.qa.sets.settings",
        "compare_sets": "panokit.qa.sets.comparing",
        "describe": "panokit.qa.sets.descriptors",
        "find_near_duplicates": "panokit.qa.sets.duplicates",
        "light_class": "panokit.qa.sets.classes",
        "measure": "panokit.qa.sets.measured",
        "members_of": "panokit.qa.sets.members",
    },
)
