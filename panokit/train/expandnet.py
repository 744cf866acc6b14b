"""Training ExpandNet as published, on probes: the baseline that shares our data.

The crops are cut from photographed probes and, as published, the truth of each is scaled to
[0, 1] by its own darkest and brightest value. The published tone mappers are replaced by the
cameras that panokit's own networks are trained with, so that the two differ in their
architecture and loss alone.
"""

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import torch
from numpy.typing import NDArray

from panokit.color.camera import photograph
from panokit.errors import ModelError
from panokit.evaluate.probe_set import ListedProbe, assign_folds, read_probes
from panokit.io.files import atomic_write, write_json
from panokit.networks.expandnet import ExpandNet, expandnet_loss
from panokit.train.examples import TRAINING_CAMERA
from panokit.train.expandnet_recipe import ExpandNetRecipe, read_expandnet_recipe
from panokit.train.history import NOTE_EVERY, History
from panokit.train.probes import check_rights
from panokit.train.release import export
from panokit.train.team import ALONE, Team

CHECKPOINT_EVERY = 100
PARITY = 1e-5
MODEL_FILE = "expandnet.onnx"

logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PhotographedProbe:
    """A probe and pictures of it.

    Attributes:
        radiance: (512, 1024, 3) float32, linear.
        pictures: (512, 1024, 3) uint8 each.
    """

    radiance: NDArray[np.float32]
    pictures: tuple[NDArray[np.uint8], ...]


def train_expandnet(
    recipe_path: Path,
    probes_folder: Path,
    work: Path,
    *,
    own_right: str = "",
    team: Team = ALONE,
) -> Path:
    """Train the recipe and write `expandnet.onnx` and `training.json` beside it.

    A run that was stopped goes on from its checkpoint in `work`.

    Args:
        recipe_path: models/<id>/expandnet.toml.
        probes_folder: With a manifest.csv.
        work: For the checkpoint and the history.
        own_right: What gives the right to train with probes whose license does not.
        team: That trains it, see `panokit.train.team.team_of`; its first process writes.

    Returns:
        The ONNX file.

    Raises:
        LicenseError: If the license of a probe does not permit training.
    """
    recipe = read_expandnet_recipe(recipe_path)
    probes = read_probes(probes_folder)
    checkpoints = work / "checkpoints" / f"{recipe.id}-{recipe.digest[:12]}"
    return train_without(
        recipe, probes, recipe_path.parent, checkpoints, own_right=own_right, team=team
    )


def train_without(
    recipe: ExpandNetRecipe,
    probes: Sequence[ListedProbe],
    folder: Path,
    work: Path,
    *,
    own_right: str = "",
    team: Team = ALONE,
) -> Path:
    """Train a recipe on all folds but the one that it holds out.

    Args:
        recipe: What to train.
        probes: All of them.
        folder: Where `expandnet.onnx` and, last, `training.json` go.
        work: For the checkpoint and the history.
        own_right: See `train_expandnet`.
        team: See `train_expandnet`.

    Returns:
        The ONNX file.

    Raises:
        LicenseError: If the license of a probe does not permit training.
    """
    folds = assign_folds(probes, recipe.folds)
    known = [p for p, fold in zip(probes, folds, strict=True) if fold != recipe.held_out]
    check_rights(known, own_right)
    photographed = [_photographed(probe, recipe, i) for i, probe in enumerate(known)]
    work.mkdir(parents=True, exist_ok=True)
    checkpoint = work / "expandnet.pt"
    network, losses = fit_expandnet(photographed, recipe, checkpoint=checkpoint, team=team)
    path = folder / MODEL_FILE
    if team.leads:
        export_expandnet(network, path)
        write_json(folder / "training.json", training_record(recipe, known, losses))
    team.wait()
    return path


def fit_expandnet(
    probes: Sequence[PhotographedProbe],
    recipe: ExpandNetRecipe,
    *,
    checkpoint: Path | None = None,
    team: Team = ALONE,
) -> tuple[ExpandNet, list[float]]:
    """Train the network; the random choices of a step depend on (seed, step) alone.

    Returns:
        The network in evaluation mode, and the mean loss of each 100 steps.

    Raises:
        ModelError: If training diverged.
    """
    torch.manual_seed(recipe.seed)
    network = ExpandNet().to(team.device)
    optimizer = torch.optim.Adam(network.parameters(), lr=recipe.learning_rate)
    step, losses, recent = 0, [], []
    if checkpoint is not None and checkpoint.exists():
        state = torch.load(checkpoint, weights_only=True, map_location="cpu")
        network.load_state_dict(state["network"])
        optimizer.load_state_dict(state["optimizer"])
        step, losses = state["step"], state["losses"]
    writes = checkpoint is not None and team.leads
    history = History(checkpoint.parent if writes and checkpoint else None, "expandnet", step)
    network.train()
    while step < recipe.steps:
        random = np.random.default_rng([recipe.seed, step])
        crops = [cut_crop(probes[int(random.integers(len(probes)))], recipe, random)
                 for _ in range(recipe.batch)]  # fmt: skip
        crops = [crops[i] for i in team.part(np.arange(recipe.batch))]
        pictures, truths = (
            torch.from_numpy(np.stack(x)).to(team.device) for x in zip(*crops, strict=True)
        )
        # bfloat16 halves the time of a step on processors that have it; the loss stays exact.
        with team.autocast(recipe.precision):
            light = network(pictures)
        loss = expandnet_loss(light.float(), truths)
        optimizer.zero_grad(set_to_none=True)
        loss.backward()
        team.average_gradients(network)
        optimizer.step()
        step += 1
        recent.append(float(loss.detach()))
        if step % NOTE_EVERY == 0 or step == recipe.steps:
            history.note(step, {"loss": recent[-1]}, recipe.learning_rate)
        if step % CHECKPOINT_EVERY == 0 or step == recipe.steps:
            if not np.isfinite(recent).all():
                raise ModelError("ExpandNet diverged. Lower the recipe's learning rate.")
            losses.append(round(float(np.mean(recent)), 5))
            logger.info("expandnet step %d loss %.4f", step, losses[-1])
            recent = []
            if writes and checkpoint is not None:
                _save(checkpoint, network, optimizer, step, losses)
    history.close()
    return network.cpu().eval(), losses


def cut_crop(
    probe: PhotographedProbe, recipe: ExpandNetRecipe, random: np.random.Generator
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """One square of a probe: the picture and the light behind it.

    Returns:
        (3, S, S) float32 in [0, 1], display-encoded; and (3, S, S) float32, linear, scaled to
        [0, 1].
    """
    height, width = probe.radiance.shape[:2]
    picture = probe.pictures[random.integers(len(probe.pictures))]
    bounds = np.log([recipe.smallest_crop_px, recipe.largest_crop_px])
    side = min(round(float(np.exp(random.uniform(*bounds)))), height)
    top = int(random.integers(height - side + 1))
    columns = (int(random.integers(width)) + np.arange(side)) % width
    mirrored = random.random() < 0.5
    cut = []
    for values in (picture, probe.radiance):
        square = np.ascontiguousarray(values[top : top + side, columns])
        size = (recipe.crop_px, recipe.crop_px)
        small = cv2.resize(square.astype(np.float32), size, interpolation=cv2.INTER_AREA)
        small = small[:, ::-1] if mirrored else small
        cut.append(np.ascontiguousarray(small.transpose(2, 0, 1), np.float32))
    return np.clip(cut[0] / 255, 0, 1), _scaled(cut[1])


def export_expandnet(network: ExpandNet, path: Path) -> None:
    """Write the network as ONNX, any height and width, equal to torch within 1e-5.

    Raises:
        ModelError: If ONNX Runtime gives something else.
    """
    example = torch.rand(1, 3, 96, 160)
    height, width = torch.export.Dim("height"), torch.export.Dim("width")
    export(network, {"picture": example}, ("light",), {2: height, 3: width}, path)
    check_parity(network, path)


def check_parity(network: ExpandNet, path: Path) -> float:
    """The largest difference between torch and ONNX Runtime at another size, relative.

    Raises:
        ModelError: If it is more than `PARITY`.
    """
    from panokit.inference import Session

    picture = torch.rand(1, 3, 128, 256, generator=torch.Generator().manual_seed(1))
    with torch.inference_mode():
        expected = network(picture).numpy()
    found = Session(path).run({"picture": picture.numpy()})["light"]
    difference = float(np.abs(found - expected).max() / np.abs(expected).max())
    if difference > PARITY:
        raise ModelError(
            f"{path} differs from torch by {difference:.1e} of its largest value, more than "
            f"{PARITY:.0e}. Export with another version of torch."
        )
    return difference


def training_record(
    recipe: ExpandNetRecipe, known: Sequence[ListedProbe], losses: Sequence[float]
) -> dict[str, object]:
    """What training.json holds: which probes were seen, and how the loss fell."""
    return {
        "recipe_digest": recipe.digest,
        "seen": {probe.name: probe.sha256 for probe in known},
        "loss_per_100_steps": list(losses),
    }


def _photographed(probe: ListedProbe, recipe: ExpandNetRecipe, index: int) -> PhotographedProbe:
    radiance = probe.radiance()
    seeds = [(recipe.seed * 1000 + index) * 1000 + shot for shot in range(recipe.shots_per_probe)]
    pictures = tuple(photograph(radiance, TRAINING_CAMERA, seed=seed).pixels for seed in seeds)
    return PhotographedProbe(radiance=radiance, pictures=pictures)


def _scaled(values: NDArray[np.float32]) -> NDArray[np.float32]:
    low, high = float(values.min()), float(values.max())
    return np.asarray((values - low) / max(high - low, 1e-12), np.float32)


def _save(
    path: Path,
    network: ExpandNet,
    optimizer: torch.optim.Optimizer,
    step: int,
    losses: Sequence[float],
) -> None:
    state = {
        "network": network.state_dict(),
        "optimizer": optimizer.state_dict(),
        "step": step,
        "losses": list(losses),
    }
    with atomic_write(path) as temporary:
        torch.save(state, temporary)
