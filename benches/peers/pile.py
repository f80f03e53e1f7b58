"""The pile in Fallwerk: processor time, and the depth of cubes in each other over the last second by the separating axes of all pairs."""

import json
import subprocess
import tempfile
from itertools import product
from pathlib import Path

import numpy as np

from common import row

EDGE_M = 0.4


def axes(orientations):
    """Edges of the cubes, one in each row of a matrix, from quaternions (w, x, y, z)."""
    w, x, y, z = np.asarray(orientations).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
        [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
        [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def deepest_m(frame):
    """Largest overlap of two cubes: the least over 6 face normals and 9 products of edges."""
    places, edges = np.array(frame["position_m"]), axes(frame["orientation"])
    apart = places[None] - places[:, None]
    first, second = np.where(np.triu((apart**2).sum(-1) < 3 * EDGE_M**2, 1))
    if not len(first):
        return 0.0
    way, a, b = apart[first, second], edges[first], edges[second]

    def overlap(n):
        reach = sum(np.abs((e[:, i] * n).sum(1)) for e in (a, b) for i in range(3))
        return 0.5 * EDGE_M * reach - np.abs((way * n).sum(1))

    least = np.min([overlap(e[:, i]) for e in (a, b) for i in range(3)], axis=0)
    for i, j in product(range(3), range(3)):
        n = np.cross(a[:, i], b[:, j])
        length = np.linalg.norm(n, axis=1)
        crossed = overlap(n / np.maximum(length, 1e-12)[:, None])
        least = np.where(length > 1e-8, np.minimum(least, crossed), least)
    return max(float(least.max()), 0.0)


def fallwerk(program, case, step):
    """A run with steps of `step` seconds."""
    model = json.loads(Path(case.file).read_text())
    model["settings"]["time_step_s"] = step
    with tempfile.TemporaryDirectory() as folder:
        file, output = Path(folder) / "pile.json", Path(folder) / "out"
        file.write_text(json.dumps(model))
        done = subprocess.run([program, "simulate", file, "-o", output, "--json"], check=True, capture_output=True, text=True)
        result = json.loads((output / "result.json").read_text())
    last = (f for t, f in zip(result["times_s"], result["frames"]) if t >= case.end_s - 1.0)
    deepest = max(map(deepest_m, last))
    return row(case, "Fallwerk", "sweeps and conjugate directions", step, json.loads(done.stdout)["cpu_s"], note=f"penetration {1e3 * deepest:.2f} mm")
