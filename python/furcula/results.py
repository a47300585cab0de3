"""What identify, diagnose and search_walk return: the JSON documents of Furcula as dataclasses, with arrays beside them.

Fields have the names of the documents (``docs/schemas/*.json``); ``document`` is the document itself. A figure that was not
computed is None. SI units; the name of a quantity ends in its unit.
"""
from __future__ import annotations

import os
from dataclasses import dataclass, field, fields
from typing import Any, Dict, List, Optional, Tuple

import numpy as np

from . import _core

__all__ = [
    "Cause", "Channel", "Check", "Diagnosis", "Estimate", "Event", "Experiment", "Finding", "Identification", "MapProposal",
    "Parameter", "Replay", "Rival", "Trace", "WalkResult"
]

Interval = Tuple[Optional[float], Optional[float]]


@dataclass(frozen=True)
class Estimate:
    """A fitted number with its 95 % interval."""

    name: str
    unit: str
    value: Optional[float]
    ci95: Interval


@dataclass(frozen=True)
class Cause:
    """An effect of the catalogue at its locations, or a parameter of the model (then ``model_parameter`` is its name)."""

    effect: Optional[str]
    model_parameter: Optional[str]
    location_type: Optional[str]
    locations: List[str]
    parameters: Dict[str, Estimate]

    @property
    def label(self) -> str:
        """As the program prints it: ``coulomb_friction@elbow``."""
        name = self.effect or self.model_parameter or ""
        return name + ("@" + ",".join(self.locations) if self.locations else "")


@dataclass(frozen=True)
class Rival:
    """Causes that compete with a finding; no causes: the model re-fitted without any."""

    causes: List[Cause]
    retained_causes: List[Cause]
    reason: str
    same_law: bool


@dataclass(frozen=True)
class Event:
    """A slip of an encoder, ``time_s`` after the first row of the log; ``step`` in ``unit`` (m or rad)."""

    log: str
    time_s: Optional[float]
    step: Optional[float]
    unit: str


@dataclass(frozen=True)
class Finding:
    """A cause that the logs show, with what supports it."""

    cause: Cause
    phase: Optional[str]
    gain: Dict[str, Any]
    confidence: Optional[float]
    confidence_lowered_by: List[str]
    events: List[Event]
    observed_events: List[Event]
    alternatives: List[Rival]
    indistinguishable_from: List[Rival]
    explanation: str
    where_to_look: str
    next_experiment: str

    @property
    def effect(self) -> Optional[str]:
        return self.cause.effect

    @property
    def locations(self) -> List[str]:
        return self.cause.locations

    @property
    def parameters(self) -> Dict[str, Estimate]:
        return self.cause.parameters


@dataclass(frozen=True)
class Experiment:
    """A recording that would distinguish causes. ``scenario``: TOML for simulate(scenario_toml=...)."""

    description: str
    recordings: Optional[int]
    deviance: Optional[float]
    scenario: Optional[str]
    rms_difference: Optional[float]
    unit: str


@dataclass(frozen=True)
class Parameter:
    """A parameter of the model that was identified.

    ``verdict``: identified, correlated (with ``correlated_with``), at_bound (``bound``: lower or upper) or not_excited.
    ``folds``: estimates with one fold left out each.
    """

    name: str
    unit: str
    given: Optional[float]
    value: Optional[float]
    ci95: Interval
    verdict: str
    folds: np.ndarray
    correlated_with: Optional[str] = None
    bound: Optional[str] = None


@dataclass(frozen=True)
class Trace:
    """A channel over one held-out window: arrays of one length, ``time_s`` in s, the others in ``unit``.

    Predictions by the model as given, re-fitted, and extended with the findings. Of an identification ``identified`` is the
    prediction of the identified model and ``refitted`` and ``extended`` are empty; of a diagnosis ``identified`` is empty.
    """

    log: str
    channel: str
    unit: str
    time_s: np.ndarray = field(repr=False)
    measured: np.ndarray = field(repr=False)
    as_given: np.ndarray = field(repr=False)
    refitted: np.ndarray = field(repr=False)
    extended: np.ndarray = field(repr=False)
    identified: np.ndarray = field(repr=False)


@dataclass(frozen=True)
class Check:
    """What is in a log. ``columns``: with the map's names; ``warnings``: what was left out, repaired or is odd, in sentences."""

    path: str
    machine: str
    columns: List[str]
    ignored_columns: List[str]
    rows: int
    rejected_rows: int
    duration_s: float
    interval_min_s: float
    interval_median_s: float
    interval_mean_s: float
    interval_max_s: float
    warnings: List[str]


@dataclass(frozen=True)
class MapProposal:
    """A map file for a log with other column names.

    ``text``: the file. ``columns``: by Furcula's names, the columns of the log. ``sureness``: of each "sure", "likely" or "confirm".
    ``notes``: what the equation of motion found, in sentences. ``not_found``: columns that the model asks for; ``not_used``: of the log.
    """

    text: str = field(repr=False)
    columns: Dict[str, List[str]]
    sureness: Dict[str, str]
    notes: List[str]
    not_found: List[str]
    not_used: List[str]

    def write(self, path: "str | os.PathLike[str]") -> None:
        """Writes the map file (TOML)."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.text)


@dataclass(frozen=True)
class Channel:
    """A measured column and its prediction, arrays of one length in ``unit``; nan where no window is. ``nmse`` None: it does not move."""

    channel: str
    unit: str
    rmse: Optional[float]
    nmse: Optional[float]
    measured: np.ndarray = field(repr=False)
    predicted: np.ndarray = field(repr=False)


@dataclass(frozen=True)
class Replay:
    """A model run on a log's inputs, window by window. ``window``: of each row, from 1; 0: none. ``channels``: by column."""

    time_s: np.ndarray = field(repr=False)
    window: np.ndarray = field(repr=False)
    channels: Dict[str, Channel]
    csv: str = field(repr=False)

    def write(self, path: "str | os.PathLike[str]") -> None:
        """Writes measured and predicted values as CSV."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.csv)


@dataclass(frozen=True)
class Diagnosis:
    """What a model gets wrong (document ``furcula-diagnosis/2``).

    ``verdict``: adequate, explained, partly_explained, unexplained or not_identifiable. ``baseline``, ``refitted``, ``extended``:
    held-out errors of the model as given, re-fitted, and with the findings. ``model``: the extended model. ``report``: the
    report as an HTML page.
    """

    kind: str
    verdict: str
    summary: str
    data: Dict[str, Any]
    baseline: Dict[str, Any]
    refitted: Dict[str, Any]
    extended: Dict[str, Any]
    noise_floor: Dict[str, Optional[float]]
    findings: List[Finding]
    unexplained: Dict[str, Any]
    missing_force: List[Dict[str, Any]]
    next_experiment: str
    experiments: List[Experiment]
    parameters: Dict[str, Dict[str, Any]]
    base_parameters: List[Dict[str, Any]]
    candidates: List[Dict[str, Any]]
    notes: List[str]
    files: Dict[str, List[str]]
    model: _core.Model = field(repr=False)
    traces: List[Trace] = field(repr=False)
    report: str = field(repr=False)
    document: Dict[str, Any] = field(repr=False)
    text: str = field(repr=False)
    found: Any = field(repr=False, compare=False)

    def write(self, folder: "str | os.PathLike[str]") -> None:
        """Writes diagnosis.json, report.html, extended_model.toml and traces/ (measured and predicted values of all logs as CSV, and a
        layout of PlotJuggler) into the folder, which is made if it does not exist."""
        _write(folder, {"diagnosis.json": self.text, "report.html": self.report, **self.found.trace_files()},
               "extended_model", self.model)


@dataclass(frozen=True)
class Identification:
    """Parameters of a model from logs (document ``furcula-identification/2``).

    ``parameters``: by name. ``covariance``: of a tree's parameters, (P, P) in their order; of other machines (0, 0). ``model``:
    the identified model. ``traces``, ``report``: of machines with one joint; of a tree empty.
    """

    kind: str
    method: str
    parameters: Dict[str, Parameter]
    derived: Dict[str, Any]
    cross_validation: Dict[str, Any]
    as_given: Dict[str, Optional[float]]
    held_out: Dict[str, Optional[float]]
    equation_error: Optional[Dict[str, Any]]
    data: Dict[str, Any]
    notes: List[str]
    covariance: np.ndarray
    model: _core.Model = field(repr=False)
    traces: List[Trace] = field(repr=False)
    report: str = field(repr=False)
    document: Dict[str, Any] = field(repr=False)
    text: str = field(repr=False)
    found: Any = field(repr=False, compare=False)

    def write(self, folder: "str | os.PathLike[str]") -> None:
        """Writes identification.json, identified_model.toml, traces/ and, where there is one, report.html into the folder."""
        files = {"identification.json": self.text, **self.found.trace_files()}
        if self.report:
            files["report.html"] = self.report
        _write(folder, files, "identified_model", self.model)


@dataclass(frozen=True)
class WalkResult:
    """The best walk of a search (document ``furcula-walk/1``, docs/biped.md).

    ``found``: whether it keeps all limits. ``cot``: its cost of transport. ``walk``: its parameters, text of a walk.toml, for
    simulate_walk and as the start of another search. ``history``: (H, 4): processor time in s, objective, cost of transport (nan:
    none), steps of simulation, whenever the best improved. ``robustness``: the walk under other steps, slopes, masses and noise, and on
    other robots.
    """

    found: bool
    cot: Optional[float]
    distance_m: float
    landings: int
    limits: List[str]
    steps: int
    rollouts: int
    cpu_s: float
    energy_j: Dict[str, float]
    history: np.ndarray
    robustness: Optional[Dict[str, Any]]
    walk: str = field(repr=False)
    report: str = field(repr=False)
    document: Dict[str, Any] = field(repr=False)
    text: str = field(repr=False)

    def write(self, folder: "str | os.PathLike[str]") -> None:
        """Writes walk.toml, walk.json and report.html into the folder."""
        _write(folder, {"walk.toml": self.walk, "walk.json": self.text, "report.html": self.report})


def _write(folder, files, model_name="", model=None):
    os.makedirs(os.path.join(folder, "traces") if any(n.startswith("traces/") for n in files) else folder, exist_ok=True)
    if model is not None:
        files = {**files, **model._files_for(model_name + ".toml", os.fsencode(os.path.abspath(folder)))}
    for name, text in files.items():
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(text)


def _replay(found):
    found["channels"] = {d["channel"]: Channel(**d) for d in found["channels"]}
    return Replay(**found)


def _estimates(document):
    return {name: Estimate(name, e["unit"], e["value"], tuple(e["ci95"])) for name, e in document.items()}


def _cause(document):
    return Cause(document.get("effect"), document.get("model_parameter"), document.get("location_type"),
                 list(document.get("locations", [])), _estimates(document["parameters"]))


def _causes(documents):
    return [_cause(d) for d in documents]


def _rivals(documents):
    return [Rival(_causes(d["causes"]), _causes(d["retained_causes"]), d["reason"], d["same_law"]) for d in documents]


def _with_unit(document, prefix):
    """The value under the key that begins so, and the unit that it ends with."""
    for key, value in document.items():
        if key.startswith(prefix):
            return value, key[len(prefix):]
    return None, ""


def _events(documents):
    return [Event(d["log"], d["time_s"], *_with_unit(d, "step_")) for d in documents]


def _finding(d):
    return Finding(_cause(d), d["phase"], d["gain"], d["confidence"], d["confidence_lowered_by"], _events(d["events"]),
                   _events(d["observed_events"]), _rivals(d["alternatives"]), _rivals(d["indistinguishable_from"]),
                   d["explanation"], d["where_to_look"], d["next_experiment"])


def _experiment(d):
    return Experiment(d["description"], d["recordings"], d["deviance"], d["scenario"], *_with_unit(d, "rms_difference_"))


def _traces(found, identification):
    out = []
    for t in found.traces:
        t["identified"] = np.empty(0)
        if identification:
            t["identified"], t["extended"] = t["extended"], t["identified"]
        out.append(Trace(**t))
    return out


def _as_they_stand(cls, document):
    """The fields whose names are keys of the document."""
    return {f.name: document[f.name] for f in fields(cls) if f.name in document}


def _diagnosis(found, document):
    own = _as_they_stand(Diagnosis, document)
    own["findings"] = [_finding(d) for d in document["findings"]]
    own["experiments"] = [_experiment(d) for d in document["experiments"]]
    return Diagnosis(**own, model=found.model, traces=_traces(found, False), report=found.report, document=document,
                     text=found.json, found=found)


def _numbers(values):
    return np.array([np.nan if v is None else v for v in values], dtype=float)


def _parameter(name, d):
    return Parameter(name, d["unit"], d["given"], d["value"], tuple(d["ci95"]), d["verdict"], _numbers(d["folds"]),
                     d.get("correlated_with"), d.get("bound"))


def _identification(found, document):
    own = {"derived": {}, "cross_validation": {}, "as_given": {}, "held_out": {}, "equation_error": None}
    own.update(_as_they_stand(Identification, document))
    own["parameters"] = {name: _parameter(name, d) for name, d in document["parameters"].items()}
    return Identification(**own, covariance=found.covariance, model=found.model, traces=_traces(found, True),
                          report=found.report, document=document, text=found.json, found=found)


def _walk_result(found, document):
    own = _as_they_stand(WalkResult, document)
    own["history"] = np.array([_numbers(p) for p in document["history"]], dtype=float).reshape(-1, 4)
    own.setdefault("robustness", None)  # computed for walks that keep all limits
    return WalkResult(**own, walk=found.walk, report=found.report, document=document, text=found.json)
