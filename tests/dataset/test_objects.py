"""Procedural objects: closed, seeded, of the right size, in parts; and the catalog of all."""

import subprocess
import sys

import numpy as np
import pytest
import trimesh

from panokit.dataset.objects.catalog import open_catalog
from panokit.dataset.objects.creases import corner_normals, face_normals, split_creases
from panokit.dataset.objects.kinds import KINDS, make_object
from panokit.dataset.objects.solids import Solids, flat_section
from panokit.dataset.settings import ObjectSettings
from panokit.errors import SettingsError, UsageError


def closed_bodies(mesh):
    """The bodies of a mesh, after its creases are sewn up again."""
    body = trimesh.Trimesh(np.round(mesh.vertices, 6), mesh.faces, process=True)
    body.merge_vertices(merge_norm=True, merge_tex=True)
    return body.split(only_watertight=False)


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_is_closed_centered_and_a_meter_long(kind):
    for number in range(4):
        mesh = make_object(kind, number)
        low, high = mesh.bounds
        assert np.ptp([low, high], axis=0).max() == pytest.approx(1, abs=1e-5)
        assert low + high == pytest.approx(np.zeros(3), abs=1e-5)
        assert 200 <= len(mesh.faces) <= 6000
        assert set(np.unique(mesh.part)) == set(range(mesh.part_count))
        assert mesh.part_count <= 3
        for body in closed_bodies(mesh):
            assert body.is_watertight
            assert body.volume > 0


@pytest.mark.parametrize("kind", KINDS)
def test_numbers_make_different_objects(kind):
    shapes = {make_object(kind, number).vertices.tobytes() for number in range(5)}
    assert len(shapes) == 5


def test_an_object_is_the_same_in_another_process():
    code = (
        "from panokit.dataset.objects.kinds import make_object; from hashlib import sha256;"
        "print(sha256(make_object('chair', 17).vertices.tobytes()).hexdigest())"
    )
    seen = {
        subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True,
            env={"PYTHONHASHSEED": seed},
        ).stdout
        for seed in ("1", "2")
    }  # fmt: skip
    assert len(seen) == 1


def test_an_object_without_end_and_none_that_is_not():
    assert len(make_object("vase", 10**9).faces)
    with pytest.raises(UsageError, match="Choose from armchair"):
        make_object("piano", 1)
    with pytest.raises(UsageError, match="from 0"):
        make_object("chair", -1)


def test_a_box_has_flat_faces_and_round_edges():
    solids = Solids()
    solids.box(0, (0, 0, 0), (1, 2, 3), 0.05)
    mesh = solids.mesh()
    assert len(mesh.faces) == 44
    normals = corner_normals(mesh)
    large = np.linalg.norm(face_normals(mesh.vertices, mesh.faces), axis=1) > 0.1
    # The chamfer bends the normals of a large face by little, as large faces weigh more.
    flat = face_normals(mesh.vertices, mesh.faces)[large]
    flat = flat / np.linalg.norm(flat, axis=1, keepdims=True)
    assert np.einsum("mki,mi->mk", normals[large], flat).min() > 0.99


def test_sharp_edges_are_creases_and_round_ones_are_not():
    solids = Solids()
    solids.box(0, (0, 0, 0), (1, 1, 1))
    sharp = solids.mesh()
    # Without a chamfer to speak of, 45 degrees still count as round.
    assert sharp.smooth
    vertices = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    hull = trimesh.convex.convex_hull(vertices)
    points, faces = split_creases(np.asarray(hull.vertices), np.asarray(hull.faces))
    assert len(points) == 24
    assert np.array_equal(points[faces], hull.vertices[hull.faces])
    round_ball = trimesh.creation.icosphere(2)
    points, _ = split_creases(np.asarray(round_ball.vertices), np.asarray(round_ball.faces))
    assert len(points) == len(round_ball.vertices)


def test_normals_of_a_ball_point_away_from_its_middle():
    solids, angle = Solids(), np.linspace(0, np.pi, 33)
    profile = np.stack([np.sin(angle), -np.cos(angle)], axis=1)
    profile[[0, -1], 0] = 0
    solids.lathe(0, profile, segments=64)
    mesh = solids.mesh()
    outward = mesh.vertices[mesh.faces] * 2
    assert np.einsum("mki,mki->mk", corner_normals(mesh), outward).min() > 0.99


def test_placed_solids_turn_and_lean():
    solids = Solids()
    solids.placed((0, 0, 5), turn_deg=90).box(0, (1, 0, 0), (2, 0.1, 0.1))
    solids.placed((0, 0, 0), lean_deg=90).box(0, (0, 1, 0), (0.1, 2, 0.1))
    (_, turned, _), (_, leaned, _) = solids._heap
    # Counter-clockwise from above, x goes to -z; leaned over, up goes to +z.
    assert turned[:, 2].min() == pytest.approx(3, abs=0.01)
    assert leaned[:, 2].max() == pytest.approx(2, abs=0.01)


def test_a_sweep_keeps_its_section_upright():
    solids = Solids()
    solids.sweep(0, [[0, 0, 0], [0, 0, -3]], flat_section(1.0, 0.2))
    _, points, _ = solids._heap[0]
    assert np.ptp(points, axis=0) == pytest.approx([1.0, 0.2, 3], abs=1e-6)


def test_the_catalog_lists_loads_and_credits():
    catalog = open_catalog(ObjectSettings(kinds=("chair", "vase"), per_kind=3))
    assert catalog.ids() == ("chair-0", "chair-1", "chair-2", "vase-0", "vase-1", "vase-2")
    assert catalog.kinds() == ("chair", "vase")
    mesh = catalog.load("vase-2")
    assert np.array_equal(mesh.vertices, make_object("vase", 2).vertices)
    assert catalog.source("chair-1").license == "CC0-1.0"
    digests = {catalog.digest(id) for id in catalog.ids()}
    assert len(digests) == 6
    assert all(len(digest) == 64 for digest in digests)


@pytest.mark.parametrize("id", ["chair", "piano-1", "chair-x", "chair--1", "folder/nothing", ""])
def test_ids_that_are_none_are_refused(id):
    catalog = open_catalog(ObjectSettings())
    for method in (catalog.load, catalog.source, catalog.digest):
        with pytest.raises(UsageError, match="There is no object"):
            method(id)


def test_unknown_kinds_are_refused():
    with pytest.raises(SettingsError, match="piano"):
        open_catalog(ObjectSettings(kinds=("piano",)))
