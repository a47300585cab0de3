#!/usr/bin/env python3
# Inverse dynamics of the biped from Python: one call for all states, and a call a state. Best of several runs.
#   PYTHONPATH=build/release/python /usr/bin/python3 benchmarks/python_dynamics.py
import pathlib
import time

import furcula
import numpy as np

STATES, RUNS = 20_000, 7
model = furcula.load_model(pathlib.Path(__file__).resolve().parents[1] / "models/biped/biped.toml")
rng = np.random.default_rng(1)
q, qd, qdd = (rng.uniform(-1.0, 1.0, (STATES, len(model.joints))) for _ in range(3))


def microseconds_a_state(work):
    best = float("inf")
    for _ in range(RUNS):
        begin = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - begin)
    return 1e6 * best / STATES


batched = microseconds_a_state(lambda: furcula.inverse_dynamics(model, q, qd, qdd))
looped = microseconds_a_state(lambda: [furcula.inverse_dynamics(model, *state) for state in zip(q, qd, qdd)])
print(f"inverse dynamics, {len(model.joints)} joints: {batched:.2f} us a state in one call, {looped:.2f} us in a loop")
