"""What all runners share: cases, known paths, rows of the table."""

import csv
import json
import time
from pathlib import Path


class Case:
    """A model file with the known path of its first tracked point."""

    def __init__(self, folder, name):
        self.name = name
        self.file = Path(folder) / f"{name}.json"
        self.model = json.loads(self.file.read_text())
        self.bodies = {body["id"]: body for body in self.model["bodies"]}
        known = Path(folder) / f"{name}.path.csv"
        self.known_file = known if known.exists() else None
        self.path = []
        if self.known_file:
            with open(known) as file:
                keys = ("time_s", "x_m", "y_m", "z_m")
                self.path = [[float(row[k]) for k in keys] for row in csv.DictReader(file)]
        self.end_s = self.path[-1][0] if self.path else self.model["settings"]["end_time_s"]

    def error_m(self, places):
        """Largest distance from the known path."""
        away = [sum((a - b) ** 2 for a, b in zip(place, known[1:])) ** 0.5 for place, known in zip(places, self.path)]
        # what is not a number is the worst
        return max((float("inf") if value != value else value for value in away), default=None)


def row(case, engine, method, step, seconds, error=None, energy=None, note=""):
    return {
        "case": case.name,
        "engine": engine,
        "method": method,
        "step": step,
        "cpu_s_per_s": seconds / case.end_s,
        "error_m": error,
        "energy_j": energy,
        "note": note,
    }


class Watch:
    """Processor time of this process."""

    def __init__(self):
        self.spent = 0.0

    def __enter__(self):
        self.began = time.process_time()
        return self

    def __exit__(self, *_):
        self.spent += time.process_time() - self.began
