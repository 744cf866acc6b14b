"""The shards and the documented example in the hands of the webdataset package, where it is."""

import gc
import re
import warnings
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from panokit.dataset.storage.decode import decode_png
from tests.dataset.fake import FakeMaker

GUIDE = Path(__file__).parents[3] / "docs" / "guides" / "stereo-dataset.md"


def documented_example():
    code = re.findall(r"```py\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)
    return next(block for block in code if "import webdataset" in block)


def test_the_example_names_what_there_is():
    example = documented_example()
    members = FakeMaker().make(0, 0).members
    names = re.findall(r'"([\w.]+\.(?:png|exr))"', example)
    assert len(names) >= 3
    assert set(names) <= set(members)
    compile(example, "example", "exec")


if find_spec("webdataset"):

    def test_webdataset_reads_the_shards(finished_dataset, monkeypatch, tmp_path):
        (tmp_path / "stereo-10k").symlink_to(finished_dataset)
        monkeypatch.chdir(tmp_path)
        code = (
            documented_example()
            .replace("00031", "00003")
            .replace("shardshuffle=100", "shardshuffle=2")
        )
        with warnings.catch_warnings():
            # It leaves the closing of files to the garbage collector.
            warnings.simplefilter("ignore", ResourceWarning)
            world = {}
            exec(compile(code, "example", "exec"), world)
            found = list(world.pop("samples"))
            gc.collect()
        assert len(found) == 32
        made = [FakeMaker().make(i, 0) for i in range(40)]
        expected = {decode_png(s.members["left.png"]).tobytes() for s in made if s.split == "train"}
        assert {sample["left.png"].tobytes() for sample in found} == expected
        assert found[0]["env64.exr"].dtype == np.float32
