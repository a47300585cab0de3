# Identification, diagnosis and walks: the same as the program says, with progress, and ended by the caller.
import json
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import furcula
from conftest import ARM_TOML, ARM_URDF, JOINT_TOML, SOURCE


@pytest.fixture(scope="module")
def diagnosis(arm_folder):
    runs = [arm_folder / f"run{i}.csv" for i in range(4)]
    return furcula.diagnose(arm_folder / "arm.toml", runs[:3], runs[3:])


def test_a_diagnosis_is_that_of_the_program(tmp_path, arm_folder, program, diagnosis):
    runs = [arm_folder / f"run{i}.csv" for i in range(4)]
    program("diagnose", "--model", arm_folder / "arm.toml", "--out", tmp_path, *runs[:3], "--hold-out", runs[3])
    assert diagnosis.document == json.loads((tmp_path / "diagnosis.json").read_text())
    assert diagnosis.text == (tmp_path / "diagnosis.json").read_text()


def test_the_program_takes_a_urdf_in_place_of_a_model_file(tmp_path, arm_folder, program, diagnosis):
    runs = [arm_folder / f"run{i}.csv" for i in range(4)]
    program("diagnose", "--model", arm_folder / "arm.urdf", "--out", tmp_path, *runs[:3], "--hold-out", runs[3])
    assert json.loads((tmp_path / "diagnosis.json").read_text()) == diagnosis.document
    program("sim", "--model", arm_folder / "arm.urdf", "--out", tmp_path / "sim.csv")
    assert furcula.read_log(tmp_path / "sim.csv").machine == "tree"
    (tmp_path / "page.html").write_text("<html><body>no robot</body></html>")
    ran = program("diagnose", "--model", tmp_path / "page.html", "--out", tmp_path, runs[0], status=3)
    assert "page.html" in ran.stderr and "expected" in ran.stderr


def test_dry_friction_of_the_elbow_is_found(diagnosis):
    assert diagnosis.verdict == "explained"
    [finding] = diagnosis.findings
    assert finding.cause.label == "coulomb_friction@elbow"
    friction = finding.parameters["torque_nm"]
    assert friction.unit == "N m"
    assert friction.ci95[0] <= 0.08 <= friction.ci95[1]  # as planted in conftest.py
    assert finding.alternatives == [] or finding.alternatives[0].reason
    errors = diagnosis.extended["held_out"], diagnosis.baseline["held_out"]
    assert errors[0]["rmse_angle_elbow_rad"] < errors[1]["rmse_angle_elbow_rad"]
    assert "coulomb_friction" in diagnosis.model.to_toml()
    for trace in diagnosis.traces:
        assert trace.time_s.shape == trace.measured.shape == trace.as_given.shape == trace.extended.shape
        assert trace.identified.size == 0


def test_results_are_written_as_the_program_writes_them(tmp_path, diagnosis):
    diagnosis.write(tmp_path / "out")
    assert json.loads((tmp_path / "out/diagnosis.json").read_text()) == diagnosis.document
    assert (tmp_path / "out/report.html").read_text().startswith("<!")


@pytest.mark.parametrize("in_memory", [False, True])
def test_a_written_model_is_read_back(tmp_path, arm, arm_folder, arm_logs, in_memory):
    """Its robot is the one of the given model: a file elsewhere, or text that is written beside it."""
    given = arm if in_memory else furcula.load_model(arm_folder / "arm.urdf")
    furcula.diagnose(given, arm_logs[:3], arm_logs[3:]).write(tmp_path / "out")
    model = furcula.load_model(tmp_path / "out/extended_model.toml")
    assert "coulomb_friction" in model.to_toml()
    assert (tmp_path / "out/arm.urdf").exists() == in_memory
    np.testing.assert_array_equal(furcula.mass_matrix(model, [0.3, 0.4]), furcula.mass_matrix(arm, [0.3, 0.4]))


def test_a_urdf_alone_is_a_tree_whose_drives_are_told_torques(arm_folder, arm):
    model = furcula.load_model(arm_folder / "arm.urdf")
    assert model.kind == "tree"
    assert model.joints == arm.joints == ["shoulder", "elbow"]
    assert model.parameters["kp_nmprad.elbow"] == 0


def test_logs_in_memory_give_what_files_give(arm, arm_logs, diagnosis):
    found = furcula.diagnose(arm, arm_logs[:3], arm_logs[3:], threads=1)
    assert found.verdict == diagnosis.verdict
    assert found.findings[0].parameters == diagnosis.findings[0].parameters


def test_an_extended_model_simulates_the_logs(diagnosis, arm_logs):
    """Simulated with the friction that was found, nothing is missing any more."""
    assert furcula.diagnose(diagnosis.model, arm_logs[:3], arm_logs[3:]).verdict == "adequate"


def test_an_identification_is_that_of_the_program(tmp_path, program):
    real = furcula.parse_model(JOINT_TOML.format(damping=0.12))
    logs = [furcula.simulate(real, scenario_toml=f'[run]\nduration_s = 4.0\n[torque]\nprofile = "harmonic"\namplitude_nm = 2.0\n'
                             f'period_s = {1 + k / 2}\n[sensors]\nnoise = true\n', seed=k) for k in range(3)]
    (tmp_path / "joint.toml").write_text(JOINT_TOML.format(damping=0.05))
    runs = [tmp_path / f"run{k}.csv" for k in range(3)]
    for log, run in zip(logs, runs):
        log.write(run)
    found = furcula.identify(tmp_path / "joint.toml", runs, method="both")
    program("identify", "--model", tmp_path / "joint.toml", "--method", "both", "--out", tmp_path, *runs)
    assert found.document == json.loads((tmp_path / "identification.json").read_text())
    damping = found.parameters["damping_nmspr"]
    assert damping.verdict == "identified"
    assert damping.given == 0.05
    assert damping.ci95[0] <= 0.12 <= damping.ci95[1]  # as simulated
    assert damping.folds.shape == (found.cross_validation["folds"],)
    assert found.equation_error["method"] == "equation"
    assert found.model.parameters["damping_nmspr"] == damping.value
    assert found.traces[0].identified.shape == found.traces[0].time_s.shape


def test_a_trees_parameters_have_a_covariance(arm_logs):
    text = ARM_TOML + '[free]\n"damping_nmspr.elbow" = [0.0, 1.0]\n"rotor_inertia_kgm2.shoulder" = [0.0, 0.1]\n'
    found = furcula.identify(furcula.parse_model(text, urdf=ARM_URDF), arm_logs)
    assert sorted(found.parameters) == ["damping_nmspr.elbow", "rotor_inertia_kgm2.shoulder"]
    assert found.covariance.shape == (2, 2)
    assert np.array_equal(found.covariance, found.covariance.T)


def test_progress_is_told_on_the_callers_thread(arm, arm_logs):
    told = []
    furcula.diagnose(arm, arm_logs, progress=lambda done, doing: told.append((done, doing, threading.get_ident())))
    assert told
    assert all(0 <= done <= 1 and doing and thread == threading.get_ident() for done, doing, thread in told)


def test_an_exception_of_the_progress_ends_the_work(arm, arm_logs):
    class Enough(Exception):
        pass

    def stop(done, doing):
        raise Enough

    with pytest.raises(Enough):
        furcula.diagnose(arm, arm_logs, progress=stop)


def test_other_threads_go_on_meanwhile(arm, arm_logs):
    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    furcula.diagnose(arm, arm_logs)
    done.set()
    thread.join()
    assert counted[0] > 20


def test_control_c_ends_a_search():
    code = ("import furcula\nmodel = furcula.load_model('models/biped/biped.toml')\n"
            "furcula.search_walk(model, seconds=600, progress=lambda done, doing: print(doing, flush=True))\n")
    child = subprocess.Popen([sys.executable, "-c", code], cwd=SOURCE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    child.stdout.readline()
    os.kill(child.pid, signal.SIGINT)
    _, errors = child.communicate(timeout=60)
    assert "KeyboardInterrupt" in errors


def test_a_walk_search_is_that_of_the_program(tmp_path, program):
    model = SOURCE / "models/biped/biped.toml"
    told = []
    found = furcula.search_walk(model, steps=300_000, seed=4, progress=lambda done, doing: told.append(doing))
    assert told
    assert found.history.shape[1] == 4
    # So few steps find no walk: status 4.
    program("walk", "search", "--model", model, "--steps", 300_000, "--seed", 4, "--out", tmp_path, status=0 if found.found else 4)
    assert found.walk == (tmp_path / "walk.toml").read_text()
    log = furcula.simulate_walk(model, found.walk, seconds=2.0, rate_hz=100.0)
    assert log.machine == "tree"
    assert np.allclose(np.diff(log.time_s), 0.01)


def test_a_walk_that_keeps_all_limits_has_its_robustness():
    start = (SOURCE / "models/biped/active_walk.toml").read_text()
    found = furcula.search_walk(SOURCE / "models/biped/biped.toml", steps=300_000, start=start)
    assert found.found
    assert set(found.robustness) == {"steps", "changed", "noisy", "other_robots", "return_map"}
    assert found.robustness["other_robots"]["robots"] == 64
    assert found.document["ensemble"] == 0
    robust = furcula.search_walk(SOURCE / "models/biped/biped.toml", steps=300_000, start=start, robust=True, robustness=False)
    assert robust.document["ensemble"] == 7


@pytest.mark.parametrize("call, words", [
    (lambda m, logs: furcula.diagnose(m, []), ["no log is given", "expected at least one"]),
    (lambda m, logs: furcula.diagnose(m, [logs[0], logs[0]]), ["given twice"]),
    (lambda m, logs: furcula.diagnose(m, [logs[0]], [logs[0]]), ["given twice"]),
    (lambda m, logs: furcula.diagnose(m, logs, window_s=-1.0), ["window_s", "expected"]),
    (lambda m, logs: furcula.diagnose(furcula.parse_model(JOINT_TOML.format(damping=0)), logs), ["'tree'", "'rotary_joint'"]),
    (lambda m, logs: furcula.identify(m, logs), ["free"]),
    (lambda m, logs: furcula.identify(m, logs, method="guess"), ["guess", "simulation"]),
    (lambda m, logs: furcula.identify(m, logs, folds=1), ["folds = 1"]),
    (lambda m, logs: furcula.simulate(m, scenario_toml="[run]\nduration = 1"), ["duration", "did you mean"]),
    (lambda m, logs: furcula.simulate(m, "none.toml"), ["none.toml", "cannot be read"]),
    (lambda m, logs: furcula.simulate(m, "a.toml", scenario_toml=""), ["expected one of them"]),
    (lambda m, logs: furcula.search_walk(m, steps=10), ["expected a biped"]),
    (lambda m, logs: furcula.search_walk(SOURCE / "models/biped/biped.toml", steps=10, robust=True, deviations=3.0), ["deviations = 3", "from 0 to 2"]),
    (lambda m, logs: furcula.search_walk(SOURCE / "models/biped/biped.toml"), ["one of steps and seconds"]),
    (lambda m, logs: furcula.search_walk(SOURCE / "models/biped/biped.toml", steps=10, mode="activ"), ["did you mean"]),
    (lambda m, logs: furcula.load_model(SOURCE / "models/biped/none.toml"), ["none.toml"]),
    (lambda m, logs: furcula.parse_model("[model"), ["model.toml:1"]),
    (lambda m, logs: furcula.simulate(SOURCE / "models/biped/biped.toml"), ["simulate_walk"]),
])
def test_what_cannot_be_done_is_one_error(arm, arm_logs, call, words):
    with pytest.raises(furcula.Error) as error:
        call(arm, arm_logs)
    for word in words:
        assert word in str(error.value)
