"""panokit's stitching against its peers, in one run on one machine: Markdown tables.

    python tests/benchmarks/peers/compare_stitching.py PANOKIT_DATA PEERS_PYTHON [panorama ...]

Views are cut from real panoramas, so the truth is known. Peers in PEERS_PYTHON (Pillow, pyvips,
`stitching`; requirements-stitching.txt) run in processes of their own; Hugin's nona and enblend
are used where they are installed. What cannot be run is listed as not compared. CPU is user
and system time of one process with one thread.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "VIPS_CONCURRENCY"):
    os.environ[variable] = "1"

import cv2  # noqa: E402 - after the number of threads is set
import numpy as np  # noqa: E402

from panokit.capture import TileGrid, View, local_capture  # noqa: E402
from panokit.color import srgb_decode_u8, srgb_encode_u8  # noqa: E402
from panokit.io import decode_image  # noqa: E402
from panokit.io.captures import StoredCapture  # noqa: E402
from panokit.io.files import sha256_of_bytes  # noqa: E402
from panokit.sphere import perspective_directions, perspective_view  # noqa: E402
from panokit.stitch import StitchSettings, stitch_views  # noqa: E402
from panokit.stitch.mosaic import mosaic  # noqa: E402
from panokit.stitch.reduce import Reducer  # noqa: E402

WIDTH, SIZE = 2048, 640
cv2.setNumThreads(1)


def layout():
    poses = [(45.0 * i, 0.0) for i in range(8)]
    poses += [(60.0 * i + 15, pitch) for pitch in (45.0, -45.0) for i in range(6)]
    poses += [(0.0, 90.0), (0.0, -90.0)]
    return [
        View(name=f"{n:02}.jpg", heading_deg=h, pitch_deg=p, fov_deg=90.0,
             width_px=SIZE, height_px=SIZE)
        for n, (h, p) in enumerate(poses)
    ]  # fmt: skip


def shoot(panorama, views, sigma=0.0, vignette=0.0, seed=0):
    rng = np.random.default_rng(seed)
    gains = np.exp(rng.normal(0, sigma, len(views)))
    x = (np.arange(SIZE) + 0.5) / SIZE * 2 - 1
    falloff = 1 - vignette * (x[:, None] ** 2 + x[None] ** 2) / 2
    pictures = []
    for gain, view in zip(gains, views, strict=True):
        picture = perspective_view(panorama, SIZE, SIZE, view.fov_deg, view.world_from_view)
        if sigma or vignette:
            linear = srgb_decode_u8(picture) * np.float32(gain) * falloff[..., None]
            picture = srgb_encode_u8(linear.astype(np.float32))
        jpeg = cv2.imencode(".jpg", picture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 90])[1]
        pictures.append(cv2.imdecode(jpeg, cv2.IMREAD_COLOR_RGB))
    return pictures


def shaken(views, seed=1, sigma_deg=0.3):
    rng = np.random.default_rng(seed)
    moved = []
    for view in views:
        turn = rng.normal(0, sigma_deg, 3)
        spread = max(float(np.cos(np.deg2rad(view.pitch_deg))), 0.2)
        moved.append(
            replace(
                view,
                heading_deg=view.heading_deg + turn[0] / spread,
                pitch_deg=view.pitch_deg + turn[1],
                roll_deg=turn[2],
            )
        )
    return moved


def psnr(made, truth, valid=None):
    """Over the sphere, where valid, after the best gain of each channel."""
    rows = np.sin((np.arange(len(truth)) + 0.5) / len(truth) * np.pi)[:, None]
    weight = rows * (np.ones(truth.shape[:2]) if valid is None else valid)
    errors = []
    for channel in range(3):
        a, b = made[..., channel].astype(float), truth[..., channel].astype(float)
        gain = (weight * a * b).sum() / (weight * a * a).sum()
        errors.append((weight * (gain * a - b) ** 2).sum() / weight.sum())
    return 10 * np.log10(255**2 / np.mean(errors))


def cpu(work, rounds=3):
    """The result, and the least CPU seconds of some rounds after a first."""
    result, spent = work(), []
    for _ in range(rounds):
        start = time.process_time()
        result = work()
        spent.append(time.process_time() - start)
    return result, min(spent)


def aligned(picture, truth):
    """A peer's panorama, whose heading nobody knows, laid over the truth by features."""
    sift = cv2.SIFT_create(6000)
    doubled = np.concatenate([truth, truth], axis=1)
    found = [sift.detectAndCompute(cv2.cvtColor(p, cv2.COLOR_RGB2GRAY), None)
             for p in (picture, doubled)]  # fmt: skip
    (here, a), (there, b) = found
    if a is None or len(here) < 10:
        return None
    pairs = cv2.BFMatcher().knnMatch(a, b, k=3)
    # Everything is there twice, a turn apart: the third best must be worse.
    good = [p[0] for p in pairs if len(p) == 3 and p[0].distance < 0.8 * p[2].distance]
    turn = truth.shape[1]
    source = np.float32([here[m.queryIdx].pt for m in good])
    target = np.float32([there[m.trainIdx].pt for m in good])
    target[:, 0] %= turn
    if len(good) < 12:
        return None
    scale = turn / picture.shape[1] if picture.shape[1] > turn * 0.8 else 1.0
    shift = np.median((target[:, 0] - source[:, 0] * scale + turn) % turn)
    target[:, 0] = (
        (target[:, 0] - source[:, 0] * scale - shift + turn * 1.5) % turn
        - turn / 2
        + (source[:, 0] * scale)
    )
    matrix, _ = cv2.estimateAffine2D(source, target, ransacReprojThreshold=2.0)
    if matrix is None:
        return None
    mask = (picture.max(axis=-1) > 0).astype(np.uint8) * 255
    matrix[0, 2] += 64
    size = (turn + 128, len(truth))
    moved = cv2.warpAffine(picture, matrix, size)
    covered = cv2.warpAffine(mask, matrix, size) == 255
    roll = round(shift)
    return (np.roll(moved[:, 64 : 64 + turn], roll, axis=1),
            np.roll(covered[:, 64 : 64 + turn], roll, axis=1))  # fmt: skip


def cv2_stitcher(pictures):
    stitcher = cv2.Stitcher_create(cv2.Stitcher_PANORAMA)
    start = time.process_time()
    try:
        status, picture = stitcher.stitch([p[..., ::-1].copy() for p in pictures])
    except cv2.error as error:
        return None, 0, time.process_time() - start, f"exception: {error.err}"
    spent = time.process_time() - start
    if status != 0:
        return None, 0, spent, f"status {status}"
    return picture[..., ::-1].copy(), len(stitcher.component()), spent, "OK"


def cv2_detail(pictures, views):
    """OpenCV's own blocks with the known poses: spherical warper, gains, Voronoi, bands."""
    start = time.process_time()
    scale = WIDTH / (2 * np.pi)
    warper = cv2.PyRotationWarper("spherical", scale)
    focal = SIZE / 2 / np.tan(np.deg2rad(45))
    intrinsic = np.array([[focal, 0, SIZE / 2], [0, focal, SIZE / 2], [0, 0, 1]], np.float32)
    flip = np.diag([1.0, -1.0, -1.0])
    weights = np.full((SIZE, SIZE), 255, np.uint8)
    corners, warped, masks = [], [], []
    for picture, view in zip(pictures, views, strict=True):
        rotation = (flip @ view.world_from_view.matrix @ flip).astype(np.float32)
        corner, moved = warper.warp(picture, intrinsic, rotation, cv2.INTER_LINEAR,
                                    cv2.BORDER_REFLECT)  # fmt: skip
        _, mask = warper.warp(weights, intrinsic, rotation, cv2.INTER_NEAREST,
                              cv2.BORDER_CONSTANT)  # fmt: skip
        corners.append(corner)
        warped.append(moved)
        masks.append(mask)
    compensator = cv2.detail.ExposureCompensator_createDefault(1)
    compensator.feed(corners, [cv2.UMat(w) for w in warped], [cv2.UMat(m) for m in masks])
    seams = nearest_masks(views, warper, intrinsic, flip, masks)
    blender = cv2.detail_MultiBandBlender(0, 5)
    sizes = [(w.shape[1], w.shape[0]) for w in warped]
    area = cv2.detail.resultRoi(corners=corners, sizes=sizes)
    blender.prepare(area)
    for number, (corner, picture, mask) in enumerate(zip(corners, warped, masks, strict=True)):
        even = compensator.apply(number, corner, picture.copy(), mask)
        blender.feed(cv2.UMat(np.asarray(even).astype(np.int16)), seams[number], corner)
    result, mask = blender.blend(None, None)
    spent = time.process_time() - start
    picture = np.clip(result, 0, 255).astype(np.uint8)
    # Its columns count from azimuth 0 at -pi, its rows from the zenith.
    left, top = area[0], area[1]
    canvas = np.zeros((WIDTH // 2, WIDTH, 3), np.uint8)
    covered = np.zeros((WIDTH // 2, WIDTH), bool)
    columns = (np.arange(picture.shape[1]) + left + WIDTH // 2) % WIDTH
    rows = np.clip(np.arange(picture.shape[0]) + top, 0, WIDTH // 2 - 1)
    canvas[np.ix_(rows, columns)] = picture
    covered[np.ix_(rows, columns)] = np.asarray(mask) > 0
    return canvas, covered, spent


def nearest_masks(views, warper, intrinsic, flip, masks):
    """Each direction to the view whose center is nearest; OpenCV's own finder takes minutes."""
    centers = np.stack([-view.world_from_view.matrix[:, 2] for view in views])
    seams = []
    for number, (view, mask) in enumerate(zip(views, masks, strict=True)):
        directions = perspective_directions(SIZE, SIZE, view.fov_deg, view.world_from_view)
        best = np.argmax(directions.reshape(-1, 3) @ centers.T.astype(np.float32), axis=1)
        own = (best == number).reshape(SIZE, SIZE).astype(np.uint8) * 255
        rotation = (flip @ view.world_from_view.matrix @ flip).astype(np.float32)
        _, seam = warper.warp(own, intrinsic, rotation, cv2.INTER_NEAREST, cv2.BORDER_CONSTANT)
        seams.append(cv2.bitwise_and(seam, mask))
    return seams


def children_cpu():
    import resource

    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def hugin(pictures, views, folder):
    """nona and enblend with the known poses, without photometric optimization."""
    lines = [f'p f2 w{WIDTH} h{WIDTH // 2} v360 n"TIFF_m c:LZW"', "m g1 i0"]
    for picture, view in zip(pictures, views, strict=True):
        cv2.imwrite(str(folder / view.name), picture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 90])
        lines.append(f"i w{SIZE} h{SIZE} f0 v90 y{view.heading_deg} p{view.pitch_deg} "
                     f'r{view.roll_deg} n"{view.name}"')  # fmt: skip
    (folder / "project.pto").write_text("\n".join(lines) + "\n")
    start = children_cpu()
    subprocess.run(["nona", "-o", "warped", "project.pto"], cwd=folder, check=True,
                   capture_output=True)  # fmt: skip
    warped = sorted(str(p.name) for p in folder.glob("warped*.tif"))
    subprocess.run(["enblend", "--wrap=horizontal", "-o", "out.tif", *warped], cwd=folder,
                   check=True, capture_output=True)  # fmt: skip
    spent = children_cpu() - start
    made = cv2.imread(str(folder / "out.tif"), cv2.IMREAD_COLOR)
    return cv2.cvtColor(made, cv2.COLOR_BGR2RGB), spent


OPEN_STITCHING = """
import sys, time, json, glob, cv2
cv2.setNumThreads(1)
from stitching import Stitcher
start = time.process_time()
try:
    made = Stitcher(crop=False).stitch(sorted(glob.glob(sys.argv[1] + "/*.jpg")))
    cv2.imwrite(sys.argv[2], made)
    said = "OK"
except Exception as error:
    said = f"{type(error).__name__}: {error}"[:120]
print(json.dumps([time.process_time() - start, said]))
"""


def open_stitching(pictures, views, folder, python):
    for picture, view in zip(pictures, views, strict=True):
        cv2.imwrite(str(folder / view.name), picture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 90])
    out = folder / "out.png"
    done = subprocess.run([python, "-W", "ignore", "-c", OPEN_STITCHING, str(folder), str(out)],
                          capture_output=True, text=True, check=False)  # fmt: skip
    if done.returncode != 0:
        return None, 0.0, "not compared: " + (done.stderr.strip().splitlines() or ["?"])[-1]
    spent, said = json.loads(done.stdout.strip().splitlines()[-1])
    made = cv2.imread(str(out)) if out.exists() else None
    return None if made is None else made[..., ::-1].copy(), spent, said


def compare_views(path, python):
    panorama = decode_image(path.read_bytes(), what=path.name)
    reducer = Reducer(panorama.shape[1], WIDTH)
    reducer.add(0, panorama)
    truth, _ = reducer.result()
    views = layout()
    clean, uneven = shoot(panorama, views), shoot(panorama, views, 0.15, 0.15)
    noisy = shaken(views)
    plain = StitchSettings(exposure=False, refine="none")
    even = StitchSettings(refine="none")
    rows = []

    def ours(name, pictures, poses, settings, rounds=3):
        made, spent = cpu(lambda: stitch_views(pictures, poses, WIDTH, settings), rounds)
        rows.append((name, psnr(made.pixels, truth), made.values["coverage"], spent, ""))

    def theirs(name, picture, covered, spent, said):
        if picture is None:
            rows.append((name, None, None, spent, said))
            return
        rows.append((name, psnr(picture, truth, covered), float(covered.mean()), spent, said))

    ours("panokit, no errors", clean, views, plain)
    ours("panokit, uneven, left", uneven, views, plain)
    ours("panokit, uneven", uneven, views, even)
    ours("panokit, uneven, default", uneven, views, StitchSettings())
    ours("panokit, uneven, bands", uneven, views, StitchSettings(refine="none", blend="bands"), 1)
    ours("panokit, uneven and shaken, poses left", uneven, noisy, even, 1)
    ours("panokit, uneven and shaken", uneven, noisy, StitchSettings(), 1)
    canvas, covered, spent = cv2_detail(uneven, views)
    theirs("cv2.detail, known poses, uneven", canvas, covered, spent, "gain, Voronoi, bands")
    made, used, spent, said = cv2_stitcher(uneven)
    laid = None if made is None else aligned(made, truth)
    picture, covered = laid or (None, None)
    theirs("cv2.Stitcher, uneven", picture, covered, spent, f"{said}, {used} of 22 views")
    with tempfile.TemporaryDirectory() as name:
        made, spent, said = open_stitching(uneven, views, Path(name), python)
        laid = None if made is None else aligned(made, truth)
        picture, covered = laid or (None, None)
        theirs("stitching 0.7 (OpenStitching), uneven", picture, covered, spent, said)
    if shutil.which("nona") and shutil.which("enblend"):
        with tempfile.TemporaryDirectory() as name:
            made, spent = hugin(uneven, views, Path(name))
        theirs("nona + enblend, known poses, uneven", made, np.ones(truth.shape[:2], bool),
               spent, "no photometric optimization")  # fmt: skip
    else:
        rows.append(("nona + enblend", None, None, 0, "not compared: not installed"))
    print(
        f"\n22 views of {path.stem}\n\n"
        "| what | PSNR, dB | covered | CPU, s | |\n|---|---|---|---|---|"
    )
    for name, quality, share, spent, said in rows:
        told = "-" if quality is None else f"{quality:.2f}"
        seen = "-" if share is None else f"{share:.1%}"
        print(f"| {name} | {told} | {seen} | {spent:.2f} | {said} |")
    sys.stdout.flush()


TILES = TileGrid(width_px=13312, height_px=6656, tile_width_px=512, tile_height_px=512)

PEER_TILES = """
import sys, time, io, json, glob, os
which, folder = sys.argv[1:3]
import numpy as np
def data(c, r):
    with open(f"{folder}/tiles/{c}_{r}.jpg", "rb") as f:
        return f.read()
if which == "pillow":
    from PIL import Image, __version__ as version
    def work():
        picture = Image.new("RGB", (13312, 6656))
        for r in range(13):
            for c in range(26):
                picture.paste(Image.open(io.BytesIO(data(c, r))), (c * 512, r * 512))
        return picture
else:
    import pyvips
    version = ".".join(str(pyvips.version(i)) for i in range(3))
    version = f"{pyvips.__version__} with libvips {version}"
    def work():
        tiles = [pyvips.Image.new_from_buffer(data(c, r), "") for r in range(13) for c in range(26)]
        return pyvips.Image.arrayjoin(tiles, across=26).numpy()
spent = []
for _ in range(4):
    start, wall = time.process_time(), time.perf_counter()
    made = work()
    spent.append((time.process_time() - start, time.perf_counter() - wall))
print(json.dumps([min(s[0] for s in spent), min(s[1] for s in spent), version]))
"""


def compare_tiles(path, python):
    panorama = decode_image(path.read_bytes(), what=path.name)
    big = cv2.resize(panorama, (13312, 6656), interpolation=cv2.INTER_CUBIC)
    rng = np.random.default_rng(0)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "tiles").mkdir()
        files = {}
        for column, row in TILES.cells():
            tile = big[row * 512 : row * 512 + 512, column * 512 : column * 512 + 512]
            # Grain as of a camera: enlarged pictures are too easy to decode.
            tile = np.clip(tile + rng.normal(0, 4, tile.shape), 0, 255).astype(np.uint8)
            data = cv2.imencode(".jpg", tile[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 85])[
                1
            ].tobytes()
            file = f"tiles/{column}_{row}.jpg"
            (folder / file).write_bytes(data)
            files[file] = sha256_of_bytes(data)
        stored = StoredCapture(folder=folder, capture=local_capture("x"), grid=TILES, files=files)

        def forget():
            for file in files:
                data = (folder / file).read_bytes()
                cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR_RGB)

        rows = [("decode and throw away, one thread", *timed(forget), cv2.__version__)]
        rows.append(("panokit", *timed(lambda: mosaic(stored, TILES, None)), ""))
        rows.append(("panokit, to 4096", *timed(lambda: mosaic(stored, TILES, 4096)), ""))
        for which in ("pillow", "pyvips"):
            done = subprocess.run([python, "-c", PEER_TILES, which, name], capture_output=True,
                                  text=True, check=False)  # fmt: skip
            if done.returncode == 0:
                rows.append((which, *json.loads(done.stdout.strip().splitlines()[-1])))
            else:
                rows.append((which, None, None, "not compared: " + done.stderr.strip()[-80:]))
    print("\n338 tiles to 13312x6656\n\n| what | CPU, s | wall, s | |\n|---|---|---|---|")
    for what, spent, wall, said in rows:
        print(f"| {what} | {'-' if spent is None else f'{spent:.2f}'} | "
              f"{'-' if wall is None else f'{wall:.2f}'} | {said} |")  # fmt: skip
    sys.stdout.flush()


def timed(work, rounds=4):
    spent = []
    for _ in range(rounds):
        start, wall = time.process_time(), time.perf_counter()
        work()
        spent.append((time.process_time() - start, time.perf_counter() - wall))
    return min(s[0] for s in spent), min(s[1] for s in spent)


if __name__ == "__main__":
    data, peers_python, *chosen = sys.argv[1:]
    pictures = sorted((Path(data) / "panoramas").glob("*.jpg"))
    compare_tiles(pictures[1], peers_python)
    for picture in pictures:
        if not chosen or any(name in picture.stem for name in chosen):
            compare_views(picture, peers_python)
