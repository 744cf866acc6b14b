import shutil
from pathlib import Path

import pytest

from panokit.errors import ModelError
from panokit.weights import find_model, read_model, released_models, verify_model


@pytest.fixture
def copied(tmp_path: Path) -> Path:
    folder = tmp_path / "expand-1"
    shutil.copytree(find_model("expand-1").folder, folder)
    return folder


def test_the_default_model_is_released_and_untouched():
    model = find_model("expand-1")
    assert model.task == "expand"
    assert model in released_models()
    verify_model(model)


def test_one_changed_byte_is_noticed(copied: Path):
    path = read_model(copied).path("gain")
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)
    with pytest.raises(ModelError, match="damaged"):
        verify_model(read_model(copied))


def test_a_missing_file_is_noticed(copied: Path):
    read_model(copied).path("components").unlink()
    with pytest.raises(ModelError, match="cannot read"):
        verify_model(read_model(copied))


@pytest.mark.parametrize("text", ["id = 'x'", "id = ", "files = 3\nid='x'\ntask='y'"])
def test_a_damaged_description_is_a_model_error(copied: Path, text: str):
    (copied / "model.toml").write_text(text, encoding="utf-8")
    with pytest.raises(ModelError, match="does not describe a model"):
        read_model(copied)


def test_unknown_models_and_roles_are_named_with_what_there_is():
    with pytest.raises(ModelError, match="expand-1"):
        find_model("expand-none")
    with pytest.raises(ModelError, match="components"):
        find_model("expand-1").path("depth")


def test_the_digest_depends_on_every_file(copied: Path):
    before = read_model(copied).digest
    description = copied / "model.toml"
    text = description.read_text(encoding="utf-8")
    first = read_model(copied).files["components"].sha256
    description.write_text(text.replace(first, "0" * 64), encoding="utf-8")
    assert read_model(copied).digest != before
