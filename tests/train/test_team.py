"""Several processes train as one: the same weights as alone, and one history."""

import json
import os
import socket
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from panokit.errors import SettingsError, UsageError

pytestmark = pytest.mark.train
torch = pytest.importorskip("torch")

# No dropout and no noise: what is random within a network differs from process to process.
SCRIPT = """
import sys
from pathlib import Path
import torch
from panokit.train.examples import load_examples
from panokit.train.loop import train_component_net, train_gain_net
from panokit.train.recipe import ComponentRecipe, NetworkRecipe
from panokit.train.team import team_of

examples, out = load_examples(Path(sys.argv[1])), Path(sys.argv[2])
grid = NetworkRecipe(steps=2, batch=2, dropout=0, precision="fp32")
components = ComponentRecipe(steps=4, batch=4, dropout=0, noise=0)
with team_of("cpu") as team:
    first = train_gain_net(examples, grid, seed=1, checkpoint=out / "gain.pt", team=team)
    second = train_component_net(examples, components, seed=1, checkpoint=out / "c.pt", team=team)
    states = {"gain": first.state_dict(), "components": second.state_dict()}
    torch.save(states, out / f"rank-{team.rank}.pt")
"""


def run(script: Path, examples: Path, out: Path, size: int) -> list[dict]:
    out.mkdir()
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    shared = {"OMP_NUM_THREADS": "1", "MASTER_ADDR": "127.0.0.1", "MASTER_PORT": str(port)}
    processes = [
        subprocess.Popen(
            [sys.executable, str(script), str(examples), str(out)],
            env=os.environ
            | shared
            | {"RANK": str(rank), "LOCAL_RANK": str(rank), "WORLD_SIZE": str(size)},
        )
        for rank in range(size)
    ]
    assert [process.wait(300) for process in processes] == [0] * size
    return [torch.load(out / f"rank-{rank}.pt") for rank in range(size)]


@pytest.mark.slow
def test_two_processes_train_what_one_does(probe_folder: Path, tmp_path: Path):
    from panokit.train.examples import make_examples, save_examples
    from panokit.train.probes import read_probes
    from panokit.train.recipe import DataRecipe

    examples = make_examples(read_probes(probe_folder), DataRecipe(shots_per_probe=1))
    save_examples(examples, tmp_path / "examples.npz")
    script = tmp_path / "train.py"
    script.write_text(SCRIPT, encoding="utf-8")
    (alone,) = run(script, tmp_path / "examples.npz", tmp_path / "alone", 1)
    first, second = run(script, tmp_path / "examples.npz", tmp_path / "pair", 2)
    for kind, weights in alone.items():
        for name, value in weights.items():
            assert torch.equal(first[kind][name], second[kind][name]), name
            # The order of sums differs, no more.
            assert torch.allclose(first[kind][name], value, rtol=2e-3, atol=2e-4), name
    written = [json.loads(x) for x in (tmp_path / "pair/history.jsonl").read_text().splitlines()]
    assert [(x["network"], x["step"]) for x in written] == [("gain-1", 2), ("components-1", 4)]


def test_a_batch_is_divided_without_rest():
    from panokit.train.team import Team

    picked = np.arange(6)
    parts = [Team(rank=rank, size=3).part(picked).tolist() for rank in range(3)]
    assert sorted(number for part in parts for number in part) == picked.tolist()
    assert {len(part) for part in parts} == {2}
    with pytest.raises(SettingsError, match="nproc-per-node"):
        Team(rank=0, size=4).part(picked)


def test_gradients_are_averaged_over_the_team(monkeypatch: pytest.MonkeyPatch):
    from panokit.train import team as module

    network = torch.nn.Linear(2, 1)
    network(torch.ones(1, 2)).sum().backward()
    own = [p.grad.clone() for p in network.parameters()]
    # Another process that found three times as much.
    monkeypatch.setattr(module.distributed, "all_reduce", lambda x: x.mul_(4))
    module.Team(rank=1, size=2).average_gradients(network)
    for gradient, before in zip((p.grad for p in network.parameters()), own, strict=True):
        assert torch.equal(gradient, 2 * before)


@pytest.mark.parametrize("own", [False, True])
@pytest.mark.parametrize("of_the_first", [0, 1])
def test_all_go_by_the_first_ones_verdict(own, of_the_first, monkeypatch: pytest.MonkeyPatch):
    from panokit.train import team as module

    monkeypatch.setattr(module.distributed, "broadcast", lambda x, src: x.fill_(of_the_first))
    assert module.Team(rank=1, size=2).agreed(own) is bool(of_the_first)
    assert module.ALONE.agreed(own) is own


def test_a_device_that_is_not_there_is_refused(monkeypatch: pytest.MonkeyPatch):
    from panokit.train.team import team_of

    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    with pytest.raises(UsageError, match="--device cpu"), team_of("cuda"):
        pass
    with team_of("auto") as team:
        assert team.device == "cpu" and team.leads


def test_precision_is_the_recipe_s(monkeypatch: pytest.MonkeyPatch):
    from panokit.train.team import ALONE

    layer, x = torch.nn.Linear(3, 3), torch.ones(2, 3)
    for precision, kind in (
        ("auto", torch.bfloat16),
        ("bf16", torch.bfloat16),
        ("fp32", torch.float32),
    ):
        with ALONE.autocast(precision):
            assert layer(x).dtype == kind
