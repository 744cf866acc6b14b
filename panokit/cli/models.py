"""`panokit models`: the released networks."""

from panokit.cli.options import Json
from panokit.console import Console
from panokit.weights import ReleasedModel, find_model, released_models, verify_model


def list_models(*, json: Json = False) -> int:
    """List the released models."""
    console = Console(as_json=json)
    models = released_models()
    console.table(
        ("id", "task", "license", "description"),
        [(m.id, m.task, m.license, m.description) for m in models],
    )
    console.value([_as_json(model) for model in models])
    return 0


def show(model: str, /, *, json: Json = False) -> int:
    """A model's card.

    Parameters
    ----------
    model
        Its id; see `panokit models list`.
    """
    console = Console(as_json=json)
    found = find_model(model)
    card = found.folder / "README.md"
    console.result(card.read_text(encoding="utf-8").rstrip() if card.exists() else found.id)
    console.result("\nTensors:")
    rows = [
        (name, t.type, " x ".join(map(str, t.shape)) or "number", t.meaning)
        for name, t in found.tensors.items()
    ]
    console.table(("name", "type", "shape", "what it is"), rows)
    console.result(f"\nFiles: {found.folder}")
    console.value(_as_json(found))
    return 0


def verify(*, json: Json = False) -> int:
    """Check the models' files against their digests."""
    console = Console(as_json=json)
    models = released_models()
    for model in models:
        verify_model(model)
        console.result(f"{model.id}: {len(model.files)} files as released")
    console.value({"verified": [model.id for model in models]})
    return 0


def _as_json(model: ReleasedModel) -> dict[str, object]:
    return {
        "id": model.id,
        "task": model.task,
        "license": model.license,
        "description": model.description,
        "digest": model.digest,
        "folder": str(model.folder),
        "files": {role: {"name": f.name, "sha256": f.sha256} for role, f in model.files.items()},
        "tensors": {name: tensor.to_json() for name, tensor in model.tensors.items()},
    }
