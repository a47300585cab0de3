# check, propose_map and replay, and the files of results: what the program prints and writes.
import math

import numpy as np
import pytest

import furcula


@pytest.fixture
def renamed(tmp_path, arm_folder):
    """A log under other names: degrees, and the elbow's torque of the other sign."""
    log = furcula.read_log(arm_folder / "run0.csv")
    theirs = {
        "t": log.time_s, "shoulder_pos": np.degrees(log["angle_shoulder_rad"]), "elbow_pos": np.degrees(log["angle_elbow_rad"]),
        "shoulder_tau": log["torque_shoulder_nm"], "elbow_tau": -log["torque_elbow_nm"]
    }
    path = tmp_path / "log.csv"
    np.savetxt(path, np.column_stack(list(theirs.values())), delimiter=",", header=",".join(theirs), comments="", fmt="%.12g")
    return path


def test_a_proposed_map_is_the_programs_and_makes_the_log_what_it_was(tmp_path, arm_folder, renamed, program):
    model = furcula.load_model(arm_folder / "arm.toml")
    proposal = furcula.propose_map(renamed, model)
    assert proposal.text == program("map", renamed, "--model", arm_folder / "arm.toml").stdout
    assert proposal.columns["angle_elbow_rad"] == ["elbow_pos"]
    assert not proposal.not_found and set(proposal.sureness.values()) <= {"sure", "likely", "confirm"}
    proposal.write(tmp_path / "map.toml")
    back, log = furcula.read_log(renamed, map=tmp_path / "map.toml"), furcula.read_log(arm_folder / "run0.csv")
    sign = np.sign(np.dot(back["angle_elbow_rad"], log["angle_elbow_rad"]))  # both signs together are the same motion
    for column in ("angle_shoulder_rad", "angle_elbow_rad", "torque_shoulder_nm", "torque_elbow_nm"):
        assert np.allclose(back[column], sign * log[column], atol=1e-8), column


def test_check_says_what_is_in_a_log(tmp_path, arm_folder, renamed):
    found = furcula.check(arm_folder / "run0.csv", arm_folder / "arm.toml")
    assert (found.machine, found.rows, found.rejected_rows, found.warnings) == ("tree", 1501, 0, [])
    assert found.duration_s == pytest.approx(6.0) and found.interval_median_s == pytest.approx(0.004)
    lines = (arm_folder / "run0.csv").read_text().splitlines()
    lines[50] = "torn"
    (tmp_path / "torn.csv").write_text("\n".join(lines) + "\n")
    torn = furcula.check(tmp_path / "torn.csv")
    assert torn.rows == 1500 and torn.rejected_rows == 1 and "(line 51)" in " ".join(torn.warnings)
    with pytest.raises(furcula.Error, match="log.csv"):
        furcula.check(renamed)
    with pytest.raises(furcula.Error, match="no such machine"):
        furcula.check(arm_folder / "run0.csv", machine="hoper")


def test_replay_is_the_programs(tmp_path, arm_folder, program):
    found = furcula.replay(arm_folder / "arm.toml", arm_folder / "run1.csv")
    found.write(tmp_path / "mine.csv")
    program("replay", arm_folder / "arm.toml", arm_folder / "run1.csv", "-o", tmp_path / "its.csv")
    assert (tmp_path / "mine.csv").read_text() == (tmp_path / "its.csv").read_text()
    elbow = found.channels["angle_elbow_rad"]
    judged = np.isfinite(elbow.predicted)
    assert elbow.unit == "rad" and judged.sum() > 1000 and found.window.max() > 10
    assert elbow.rmse == pytest.approx(math.sqrt(np.mean((elbow.predicted - elbow.measured)[judged]**2)))
    with pytest.raises(furcula.Error, match="window_s"):
        furcula.replay(arm_folder / "arm.toml", arm_folder / "run1.csv", window_s=-1.0)


def test_results_are_written_with_the_programs_traces(tmp_path, arm_folder, program):
    model = furcula.load_model(arm_folder / "arm.toml")
    logs = [arm_folder / f"run{i}.csv" for i in range(3)]
    furcula.diagnose(model, logs[:2], logs[2:]).write(tmp_path / "mine")
    program("diagnose", *logs[:2], "--hold-out", logs[2], "--model", arm_folder / "arm.toml", "--out", tmp_path / "its")
    names = sorted(p.name for p in (tmp_path / "its/traces").iterdir())
    assert names == sorted(p.name for p in (tmp_path / "mine/traces").iterdir()) == [
        "plotjuggler.xml", "run0.csv", "run1.csv", "run2.csv"]
    for name in names:
        assert (tmp_path / "mine/traces" / name).read_text() == (tmp_path / "its/traces" / name).read_text()
