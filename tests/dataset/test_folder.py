"""Meshes from files: normalized, cleaned, credited; refused with a reason where unusable."""

import json

import numpy as np
import pytest
import trimesh

from panokit.dataset.objects.catalog import open_catalog
from panokit.dataset.objects.creases import face_normals
from panokit.dataset.objects.folder import list_meshes, load_mesh, read_sources
from panokit.dataset.settings import ObjectSettings
from panokit.errors import ImageError, LicenseError, UsageError


@pytest.fixture
def folder(tmp_path):
    """A folder with a box as PLY and, in a subfolder, as OBJ."""
    box = trimesh.creation.box((2, 4, 1))
    box.apply_translation((10, 0, -3))
    box.export(tmp_path / "box.ply")
    (tmp_path / "more").mkdir()
    box.export(tmp_path / "more" / "crate.obj")
    return tmp_path


def write_manifest(folder, *rows):
    text = "file,license,attribution\n" + "\n".join(rows)
    (folder / "manifest.csv").write_text(text, encoding="utf-8")


def ply(vertices, faces=()):
    """An ASCII PLY file."""
    lines = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}"]
    lines += [f"property float {axis}" for axis in "xyz"]
    if len(faces):
        lines += [f"element face {len(faces)}", "property list uchar int vertex_indices"]
    lines.append("end_header")
    lines += [" ".join(map(str, vertex)) for vertex in vertices]
    lines += [" ".join(map(str, [len(face), *face])) for face in faces]
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("name", ["box.ply", "more/crate.obj"])
def test_a_mesh_is_centered_and_a_meter_long(folder, name):
    mesh = load_mesh(folder / name)
    low, high = mesh.bounds
    assert high == pytest.approx([0.25, 0.5, 0.125], abs=1e-6)
    assert low == pytest.approx(-high, abs=1e-6)
    assert len(mesh.faces) == 12
    # Every edge of a box is a crease: four vertices for each of six faces.
    assert len(mesh.vertices) == 24


def test_ids_come_from_the_paths(folder):
    assert list(list_meshes(folder)) == ["folder/box", "folder/more/crate"]
    (folder / "box.obj").write_bytes((folder / "more" / "crate.obj").read_bytes())
    assert list(list_meshes(folder)) == ["folder/box.obj", "folder/box.ply", "folder/more/crate"]


def test_equal_files_have_equal_digests(folder):
    (folder / "again.ply").write_bytes((folder / "box.ply").read_bytes())
    catalog = open_catalog(ObjectSettings(kinds=("chair",), per_kind=2, meshes=str(folder)))
    assert catalog.kinds() == ("chair", "folder")
    assert catalog.ids()[:3] == ("chair-0", "chair-1", "folder/again")
    assert catalog.digest("folder/again") == catalog.digest("folder/box")
    assert catalog.digest("folder/box") != catalog.digest("folder/more/crate")
    assert len(catalog.load("folder/again").faces) == 12


def test_a_scene_graph_is_flattened_into_parts(tmp_path):
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box((1, 1, 1)))
    up = trimesh.transformations.translation_matrix((0, 3, 0))
    scene.add_geometry(trimesh.creation.icosphere(1, radius=0.2), transform=up)
    mirror = np.diag([-1.0, 1, 1, 1])
    mirror[:3, 3] = (0, 1, 0)
    scene.add_geometry(trimesh.creation.box((0.8, 0.8, 0.8)), transform=mirror)
    scene.export(tmp_path / "scene.glb")
    mesh = load_mesh(tmp_path / "scene.glb")
    assert mesh.part_count == 3
    # The largest piece comes first.
    areas = np.linalg.norm(face_normals(mesh.vertices, mesh.faces), axis=1)
    per_part = [areas[mesh.part == part].sum() for part in range(3)]
    assert per_part == sorted(per_part, reverse=True)
    # 3.7 high in all, so the small ball's middle is near the top.
    assert mesh.vertices[mesh.faces[mesh.part == 2]].mean(axis=(0, 1))[1] > 0.4
    for part in range(3):
        body = trimesh.Trimesh(mesh.vertices, mesh.faces[mesh.part == part])
        body.merge_vertices(merge_norm=True)
        assert body.volume > 0


def test_useless_triangles_go_and_the_winding_is_made_one(tmp_path):
    box = trimesh.creation.box((1, 1, 1))
    faces = box.faces.copy()
    faces[3] = faces[3][::-1]
    faces[7] = faces[7][::-1]
    faces = np.concatenate([faces, [[0, 0, 1], [2, 2, 2]]])
    (tmp_path / "bad.ply").write_text(ply(box.vertices.tolist(), faces.tolist()))
    mesh = load_mesh(tmp_path / "bad.ply")
    assert len(mesh.faces) == 12
    body = trimesh.Trimesh(mesh.vertices, mesh.faces)
    body.merge_vertices(merge_norm=True)
    assert body.is_winding_consistent
    assert body.volume > 0


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (ply([(0, 0, 0), (1, 0, 0), (0, 1, 0)]), "no-faces"),
        (ply([(0, 0, 0), (1, 0, 0), ("nan", 1, 0)], [(0, 1, 2)]), "not-finite"),
        (ply([(0, 0, 0), (1, 0, 0), ("inf", 1, 0)], [(0, 1, 2)]), "not-finite"),
        (ply([(1, 1, 1)] * 3, [(0, 1, 2)]), "empty"),
        (ply([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)]), "no-faces"),
        ("", "unreadable"),
        ("ply\nformat ascii 1.0\nelement", "unreadable"),
        ("not a mesh at all", "unreadable"),
    ],
)
def test_unusable_files_say_why(tmp_path, text, reason):
    path = tmp_path / "broken.ply"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ImageError, match=r"broken\.ply") as caught:
        load_mesh(path)
    assert caught.value.reason == reason


def test_a_digest_of_gltf_counts_its_buffer(tmp_path):
    catalogs = []
    for name, size in (("one", 1.0), ("two", 2.0)):
        inner = tmp_path / name
        inner.mkdir()
        files = trimesh.exchange.gltf.export_gltf(trimesh.Scene(trimesh.creation.box((1, size, 1))))
        for file, data in files.items():
            (inner / file).write_bytes(data)
        gltf = next(inner.glob("*.gltf"))
        record = json.loads(gltf.read_text())
        # Bounds that say nothing: then only the buffer differs.
        for accessor in record["accessors"]:
            accessor.pop("min", None), accessor.pop("max", None)
        gltf.write_text(json.dumps(record))
        catalogs.append(open_catalog(ObjectSettings(meshes=str(inner))))
    digests = {catalog.digest(next(iter(catalog.files))) for catalog in catalogs}
    assert len(digests) == 2


def test_credits_come_from_the_table(folder):
    write_manifest(folder, "box.ply,CC-BY-4.0,Jane Doe", "more/crate.obj,CC0-1.0,")
    sources = read_sources(folder, list_meshes(folder))
    assert sources["folder/box"].license == "CC-BY-4.0"
    assert sources["folder/box"].attribution == "Jane Doe"
    assert sources["folder/more/crate"].license == "CC0-1.0"


def test_a_mesh_outside_the_table_has_an_unknown_license(folder):
    assert read_sources(folder, list_meshes(folder))["folder/box"].license == "unknown"


def test_a_license_that_asks_for_credit_gets_it_or_is_refused(folder):
    write_manifest(folder, "box.ply,CC-BY-4.0 (c) 2021 Somebody,")
    assert read_sources(folder, list_meshes(folder))["folder/box"].attribution == "© 2021 Somebody"
    write_manifest(folder, "box.ply,CC-BY-4.0,")
    with pytest.raises(LicenseError, match="asks for credit"):
        open_catalog(ObjectSettings(meshes=str(folder)))


def test_an_empty_or_missing_folder_is_refused(tmp_path):
    with pytest.raises(UsageError, match="holds no"):
        open_catalog(ObjectSettings(meshes=str(tmp_path)))
    with pytest.raises(UsageError, match="no folder"):
        open_catalog(ObjectSettings(meshes=str(tmp_path / "nowhere")))


@pytest.mark.data
def test_the_shared_meshes_all_load_and_are_credited(shared_data):
    catalog = open_catalog(ObjectSettings(kinds=("vase",), meshes=str(shared_data / "meshes")))
    assert len(catalog.files) >= 15
    for id in catalog.files:
        mesh = catalog.load(id)
        assert np.ptp(mesh.bounds, axis=0).max() == pytest.approx(1, abs=1e-5)
        source = catalog.source(id)
        assert source.license != "unknown"
        assert source.attribution or not source.license.startswith("CC-BY")
