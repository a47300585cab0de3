"""Furcula in Python: logs and models of legged robots, what a simulation gets wrong about them, and their dynamics.

    log = furcula.read_log("run1.csv")
    model = furcula.load_model("robot.toml")
    result = furcula.diagnose(model, ["run1.csv", "run2.csv", "run3.csv"])
    print(result.verdict, result.summary)

SI units throughout; names of quantities end in their units. Every function raises furcula.Error, a ValueError, where a file, a log
or an argument is unusable; its message says where, what was expected and what to do.
"""
from __future__ import annotations

import json as _json
import os as _os

from . import _core
from ._core import Error, Log, Model, __version__
from .results import (Cause, Channel, Check, Diagnosis, Estimate, Event, Experiment, Finding, Identification, MapProposal,
                      Parameter, Replay, Rival, Trace, WalkResult)
from . import results as _results

__all__ = [
    "Cause", "Channel", "Check", "Diagnosis", "Error", "Estimate", "Event", "Experiment", "Finding", "Identification", "Log",
    "MapProposal", "Model", "Parameter", "Replay", "Rival", "Trace", "WalkResult", "bias_forces", "check", "diagnose", "energy",
    "forward_dynamics", "identify", "inverse_dynamics", "load_model", "make_log", "mass_matrix", "parse_model", "propose_map",
    "read_log", "replay", "search_walk", "simulate", "simulate_walk"
]

Log.__module__ = Model.__module__ = __name__
Log.__doc__ = """A recording in memory, read only.

path, machine (its type, "hopper", "tree", ...), metadata (the ``# key: value`` lines), warnings (what was left out or repaired, in
sentences), time_s (rows,), columns: name -> (rows,). ``log["angle_rad"]`` is a column, ``len(log)`` the number of rows, ``log.write(path)``
writes it as CSV. Arrays are views of the log and cannot be written to; ``numpy.array`` copies one.
"""
Model.__doc__ = """A model: a machine with one joint, a tree of joints, a planar leg or a biped.

kind (as in the model file), path, machine (the type of its logs), joints (names, in the order of the arrays of inverse_dynamics and
the others; empty on machines with one joint), parameters (name -> value), notes (what the URDF was taken for), ``model.to_toml()`` the
text of its model file.
"""


def _path(path):
    """Bytes: names of files need not be text."""
    return _os.fsencode(path)


def read_log(path, machine="", map=None, window_s=None):
    """Reads a log: CSV (furcula-log/1 or by a map file), a ROS 2 bag (folder, .db3), or MCAP.

    machine: type of the machine where neither the log nor the map file names it: "hopper", "rail_carriage", "motor_axis",
    "rotary_joint", "clutch_bench", "tree". map: path of a map file (TOML) for other column names. window_s: the length of a prediction
    where it will be chosen, s: a slow log is then not taken for one in another unit of time.

    Rows that are torn or not finite are left out and named in ``warnings``; a log with too many of them raises Error.
    """
    return _core.read_log(_path(path), machine, "" if map is None else _path(map), window_s or 0.0)


def make_log(columns, machine, name="log", window_s=None):
    """A log of arrays. columns: name -> (rows,), time_s among them, names and units as in docs/contracts.md, section 1.

    The same checks are made as of a file. name: for messages.
    """
    return _core.make_log(columns, machine, name, window_s or 0.0)


def load_model(path, accept_inertias=False):
    """Reads a model file (TOML), or a robot (URDF, MJCF), which is taken as a tree; of a URDF all inputs are torques.

    accept_inertias: masses and moments of inertia of a URDF are taken as they are, also those that no body has.
    """
    return _core.load_model(_path(path), accept_inertias)


def parse_model(text, path="model.toml", urdf="", accept_inertias=False):
    """A model from the text of a model file. path: for messages, and its folder is where the URDF is; urdf: the URDF's text in place
    of a file. A biped is read from its file alone (load_model)."""
    return _core.parse_model(text, _path(path), urdf, accept_inertias)


def _model(model):
    return model if isinstance(model, Model) else load_model(model)


def _split(logs, held_out, model, map, window_s):
    fitted, judged = (_logs(some, model, map, window_s) for some in (logs, held_out))
    seen = set()
    for log in fitted + judged:
        if log.path in seen and _os.path.exists(log.path):
            raise Error(log.path + " is given twice; expected each log once, to fit or to hold out")
        seen.add(log.path)
    return fitted, judged


def _logs(logs, model, map, window_s):
    if isinstance(logs, (str, bytes, _os.PathLike, Log)):
        logs = [logs]
    return [log if isinstance(log, Log) else read_log(log, model.machine, map, window_s) for log in logs]


def check(path, model=None, *, machine="", map=None):
    """What is in a log, however large, as `furcula check` says it; what makes it unusable raises Error.

    model: a Model or a path, whose columns the log must have. machine: the type where neither model, log nor map names it. map: path of
    a map file. Returns a Check.
    """
    return Check(**_core.check(_path(path), None if model is None else _model(model), machine,
                               "" if map is None else _path(map)))


def propose_map(path, model):
    """Proposes the map file of a log with other column names, as `furcula map` does; a person confirms it. Returns a MapProposal."""
    return MapProposal(**_core.propose_map(_path(path), _model(model)))


def replay(model, log, *, map=None, window_s=None):
    """Runs a model on a log's recorded inputs in windows of window_s, as `furcula replay` does. Returns a Replay.

    model: a Model or a path. log: a Log or a path, with map as of read_log.
    """
    model = _model(model)
    return _results._replay(_core.replay(model, _logs(log, model, map, window_s)[0], window_s or 0.0))


def simulate(model, scenario=None, *, scenario_toml=None, seed=0):
    """Simulates a model and returns its log; without a scenario what is usual for the kind: hops, a sine drive, throws.

    model: a Model or a path. scenario: path of a scenario file; scenario_toml: its text. seed: of the errors of the sensors. The same
    arguments give the same log.
    """
    if scenario is not None and scenario_toml is not None:
        raise Error("scenario and scenario_toml are both given; expected one of them")
    name = "scenario"
    if scenario is not None:
        name = _os.fsdecode(scenario)
        try:
            with open(name, encoding="utf-8") as file:
                scenario_toml = file.read()
        except (OSError, UnicodeDecodeError) as error:
            raise Error(f"{name}: cannot be read ({error}); expected a scenario file (TOML)") from error
    return _core.simulate(_model(model), scenario_toml, name, seed)


def identify(model, logs, held_out=(), *, map=None, window_s=None, method="simulation", folds=0, threads=0, seed=1,
             trust_columns=False, progress=None):
    """Estimates the free parameters of a model from logs, as `furcula identify` does.

    model: a Model or a path. logs: Log objects or paths, at least one. held_out: logs that no fit sees; without them a seeded fifth, of a
    single log its last quarter. map: map file of logs that are given as paths. window_s: length of a prediction, s. method: "simulation",
    "equation" or "both" (on a tree simulation alone). folds: of the cross-validation; 0: as usual. threads: 0: as many as the computer
    has; the result does not depend on it. trust_columns: do not try other units, signs, zeros or joints. progress: called with
    (share done, what is being done) on this thread; an exception that it raises, and Ctrl-C, end the work.
    """
    model = _model(model)
    found = _core.identify(model, *_split(logs, held_out, model, map, window_s), window_s or 0.0,
                           threads, seed, trust_columns, method, folds, progress)
    return _results._identification(found, _json.loads(found.json))


def diagnose(model, logs, held_out=(), *, map=None, window_s=None, threads=0, seed=1, trust_columns=False, progress=None):
    """Names what a model gets wrong about logs, as `furcula diagnose` does. Arguments as of identify."""
    model = _model(model)
    found = _core.diagnose(model, *_split(logs, held_out, model, map, window_s), window_s or 0.0,
                           threads, seed, trust_columns, progress)
    return _results._diagnosis(found, _json.loads(found.json))


def search_walk(model, *, steps=None, seconds=None, mode="active", method="cmaes", seed=1, threads=0, start="", robust=False,
                deviations=0.35, robustness=True, progress=None):
    """Searches the walk of a biped that costs least, as `furcula walk search` does.

    One of steps (of simulation: one seed then gives one walk) and seconds is the budget. mode: "active", "semi_passive", "knee_passive"
    or "knee_braked". method: "cmaes" or another of `furcula walk search --help`. start: text of a walk.toml to begin with. robust: whether the
    walk has to stand on 7 other robots too, drawn within `deviations` times the ranges of document 000, and pushed. robustness: whether
    the walk is simulated again with other steps, slopes, masses, noise and robots. progress: as of identify. A search that finds no walk
    within all limits returns what came nearest, with ``found`` False.
    """
    found = _core.search_walk(_model(model), mode, method, steps, seconds, seed, threads, start, robust, deviations,
                               robustness, progress)
    return _results._walk_result(found, _json.loads(found.json))


def simulate_walk(model, walk, *, seconds=10.0, rate_hz=100.0, seed=None):
    """A walk as a log. walk: text of a walk.toml, as WalkResult.walk. seconds: 1 to 10000. rate_hz: of the rows. seed: the sensors err,
    drawn from it; None: they do not."""
    return _core.simulate_walk(_model(model), walk, seconds, rate_hz, seed)


def mass_matrix(model, q):
    """The joint-space inertia M(q), rotors included.

    q: (J,) or (N, J), positions of model.joints, rad or m. Returns (J, J) or (N, J, J), kg m^2 (kg, kg m of prismatic joints).
    """
    return _core.mass_matrix(model, q)


def inverse_dynamics(model, q, qd, qdd):
    """Torques of a motion: M(q) qdd + C(q, qd) qd + g(q) + damping qd + stiffness (q - rest).

    q, qd, qdd: (J,) or (N, J), in rad, rad/s, rad/s^2 (m, m/s, m/s^2); one of (J,) stands for all N rows. Returns (J,) or (N, J), N m (N).
    Dry friction is not in it, nor are the causes of the model file and the gains of position drives.
    """
    return _core.inverse_dynamics(model, q, qd, qdd)


def forward_dynamics(model, q, qd, tau):
    """Accelerations under torques: the inverse of inverse_dynamics. Shapes as there; tau in N m (N). Returns rad/s^2 (m/s^2)."""
    return _core.forward_dynamics(model, q, qd, tau)


def bias_forces(model, q, qd):
    """C(q, qd) qd + g(q): the torques at no acceleration, without damping and springs. Shapes as of inverse_dynamics."""
    return _core.bias_forces(model, q, qd)


def energy(model, q, qd):
    """Kinetic and potential energy, J: (2,) or (N, 2). Potential energy is 0 with all centres of mass at the height of the origin."""
    return _core.energy(model, q, qd)
