"""All the networks of one model, trained one after another with a checkpoint each."""

from pathlib import Path

from panokit.networks.component_net import ComponentEnsemble
from panokit.networks.expansion_net import ExpansionNet
from panokit.networks.gain_net import GainEnsemble
from panokit.train.examples import Examples
from panokit.train.loop import train_component_net, train_gain_net
from panokit.train.recipe import Recipe
from panokit.train.team import ALONE, Team


def train_ensemble(
    examples: Examples,
    recipe: Recipe,
    checkpoints: Path,
    *,
    component_examples: Examples | None = None,
    team: Team = ALONE,
) -> ExpansionNet:
    """Train every member of a recipe's ensembles; what is finished in `checkpoints` is kept.

    Args:
        examples: To learn from.
        recipe: How, and how many members.
        checkpoints: A folder for this recipe and these examples alone.
        component_examples: For the component networks, if not the same.
        team: That trains it.
    """
    checkpoints.mkdir(parents=True, exist_ok=True)
    gain = [
        train_gain_net(
            examples,
            recipe.network,
            seed=seed,
            checkpoint=checkpoints / f"gain-{seed}.pt",
            team=team,
        )
        for seed in range(recipe.network.members)
    ]
    components = [
        train_component_net(
            component_examples or examples,
            recipe.components,
            seed=seed,
            checkpoint=checkpoints / f"components-{seed}.pt",
            team=team,
        )
        for seed in range(recipe.components.members)
    ]
    whole = ExpansionNet(GainEnsemble(gain), ComponentEnsemble(components), recipe.grid_weight)
    return whole.eval()
