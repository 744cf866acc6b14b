"""Make the picture of docs/ideas/qa-sets.md from CC0 light probes of Poly Haven.

python docs/pictures/make_relit_pairs.py TRUTH NAME docs/pictures/relit-pairs.jpg MAPS...

TRUTH and each of MAPS are folders with a map NAME.exr.
"""

import sys
from pathlib import Path

import numpy as np

from panokit.io import read_environment_map, write_bytes
from panokit.qa.pairs import align_pair, relit_sheet
from panokit.qa.pairs.pictures import encode_sheet

GAP_PX = 24


def main(truth, name, out, folders):
    right = read_environment_map(Path(truth) / f"{name}.exr")
    parts = []
    for folder in folders:
        estimate = read_environment_map(Path(folder) / f"{name}.exr")
        sheet = relit_sheet(align_pair(estimate, right, 512))
        parts += [sheet, np.full((len(sheet), GAP_PX, 3), 255, np.uint8)]
    write_bytes(Path(out), encode_sheet(np.concatenate(parts[:-1], axis=1)))


if __name__ == "__main__":
    main(*sys.argv[1:4], sys.argv[4:])
