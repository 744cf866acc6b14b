"""One task of one peer, in the peers' environment: read input.npy, work, write the result.

worker.py TASK FOLDER REPEATS prints {"cpu_s": ..., "version": ...}, or {"missing": ...}.
"""

import json
import sys
import time
from importlib.metadata import version
from pathlib import Path

import numpy as np

ANGLE = 0.4
SEE = 640


def skylibs_rotate(picture, order):
    from envmap import EnvironmentMap

    cosine, sine = np.cos(ANGLE), np.sin(ANGLE)
    about_x = np.array([[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]])
    # It works in place, so every round needs a copy; the copy is not timed.
    return lambda fresh: EnvironmentMap(fresh, "latlong").rotate(about_x, order=order).data


def equilib_rotate(picture, torch_tensors):
    from equilib import equi2equi

    turn = {"roll": 0.0, "pitch": ANGLE, "yaw": 0.0}
    channels_first = np.ascontiguousarray(picture.transpose(2, 0, 1))
    if torch_tensors:
        import torch

        source = torch.from_numpy(channels_first)
        return lambda _: equi2equi(source, turn, mode="bilinear").numpy().transpose(1, 2, 0)
    return lambda _: equi2equi(channels_first, turn, mode="bilinear").transpose(1, 2, 0)


def py360convert_view(picture):
    import py360convert

    return lambda _: py360convert.e2p(picture, 90, 0, 0, (SEE, SEE))


def equilib_view(picture):
    from equilib import equi2pers

    source = np.ascontiguousarray(picture.transpose(2, 0, 1))
    turn = {"roll": 0.0, "pitch": 0.0, "yaw": 0.0}
    return lambda _: equi2pers(source, turn, SEE, SEE, 90.0, mode="bilinear").transpose(1, 2, 0)


def py360convert_cube(picture):
    import py360convert

    return lambda _: py360convert.e2c(picture, 1024, cube_format="list")[0]


def skylibs_shrink(picture):
    from envmap import EnvironmentMap

    return lambda fresh: EnvironmentMap(fresh, "latlong").resize((32, 64)).data


TASKS = {
    "skylibs rotate order 1": ("skylibs", lambda p: skylibs_rotate(p, 1)),
    "skylibs rotate order 3": ("skylibs", lambda p: skylibs_rotate(p, 3)),
    "equilib rotate numpy": ("pyequilib", lambda p: equilib_rotate(p, False)),
    "equilib rotate torch": ("pyequilib", lambda p: equilib_rotate(p, True)),
    "py360convert view": ("py360convert", py360convert_view),
    "equilib view": ("pyequilib", equilib_view),
    "py360convert cube": ("py360convert", py360convert_cube),
    "skylibs shrink": ("skylibs", skylibs_shrink),
}


def main():
    task, folder, repeats = sys.argv[1], Path(sys.argv[2]), int(sys.argv[3])
    package, prepare = TASKS[task]
    picture = np.load(folder / "input.npy")
    try:
        work = prepare(picture)
    except ImportError as error:
        print(json.dumps({"missing": f"{package}: {error}"}))
        return
    best = np.inf
    for _ in range(repeats):
        fresh = picture.copy()
        started = time.process_time()
        result = work(fresh)
        best = min(best, time.process_time() - started)
    np.save(folder / "result.npy", np.asarray(result, np.float32))
    print(json.dumps({"cpu_s": best, "version": version(package)}))


if __name__ == "__main__":
    main()
