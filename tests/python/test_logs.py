# Logs: read, made, written; what is wrong with them is said.
import os

import numpy as np
import pytest

import furcula
from conftest import SOURCE


def test_columns_of_a_csv_are_those_that_numpy_reads(tmp_path, arm_logs):
    path = tmp_path / "run.csv"
    arm_logs[0].write(path)
    table = np.genfromtxt(path, delimiter=",", names=True, comments="#", skip_header=sum(
        line.startswith("#") for line in path.read_text().splitlines()))
    log = furcula.read_log(path)
    assert log.machine == "tree"
    assert len(log) == table.size
    for name in table.dtype.names:
        assert np.array_equal(log[name], table[name])
    assert np.array_equal(log.time_s, log.columns["time_s"])


def test_a_bag_and_an_mcap_are_read_as_the_program_converts_them(tmp_path, program):
    for name in ("arm.mcap", "bag"):
        source = SOURCE / "tests/host/bags/data" / name
        program("convert", source, "--out", tmp_path / "bag.csv")
        converted, log = furcula.read_log(tmp_path / "bag.csv"), furcula.read_log(source)
        assert len(log) == len(converted) > 0
        for column, values in log.columns.items():
            assert np.array_equal(values, converted[column])
        assert any("/joint_states" in warning for warning in log.warnings)


def test_a_map_file_names_columns_of_another_log(tmp_path):
    (tmp_path / "log.csv").write_text("t;deg;nm\n0,0;90,0;1,5\n0,01;180,0;2,5\n0,02;90,0;1,0\n")
    (tmp_path / "map.toml").write_text('machine_type = "rotary_joint"\nseparator = ";"\ndecimal = ","\ntime_s = { column = "t" }\n'
                                       'angle_rad = { column = "deg", scale = 0.017453292519943295 }\ntorque_nm = { column = "nm" }\n')
    log = furcula.read_log(tmp_path / "log.csv", map=tmp_path / "map.toml")
    assert log["angle_rad"] == pytest.approx([np.pi / 2, np.pi, np.pi / 2])
    assert log["torque_nm"] == pytest.approx([1.5, 2.5, 1.0])


def test_a_log_of_arrays_is_read_back_to_the_bit(tmp_path):
    rng = np.random.default_rng(7)
    columns = {"time_s": np.arange(50) * 1e-3, "angle_rad": rng.normal(size=50), "torque_nm": rng.normal(size=50)}
    log = furcula.make_log(columns, "rotary_joint")
    log.write(tmp_path / "log.csv")
    again = furcula.read_log(tmp_path / "log.csv")
    for name, values in columns.items():
        assert np.array_equal(log[name], values)
        assert np.array_equal(again[name], values)


def test_arrays_are_read_only_and_outlive_the_log(arm_logs):
    log = furcula.make_log({"time_s": [0.0, 0.1], "angle_rad": [1.0, 2.0], "torque_nm": [0.0, 0.0]}, "rotary_joint")
    angle = log["angle_rad"]
    with pytest.raises(ValueError):
        angle[0] = 5.0
    del log
    assert list(angle) == [1.0, 2.0]


def test_a_torn_row_is_left_out_and_said(tmp_path):
    rows = [f"{k / 100:.2f},0.{k % 10},0.0" for k in range(100)]
    rows[40] = "0.40,nan,0.0"
    (tmp_path / "log.csv").write_text("# machine_type: rotary_joint\ntime_s,angle_rad,torque_nm\n" + "\n".join(rows) + "\n")
    log = furcula.read_log(tmp_path / "log.csv")
    assert len(log) == 99
    assert any("row 41" in warning for warning in log.warnings)


@pytest.mark.parametrize("call, words", [
    (lambda folder: furcula.read_log(folder / "none.csv"), ["none.csv", "cannot be read", "expected"]),
    (lambda folder: furcula.read_log(folder), ["expected"]),
    (lambda folder: furcula.read_log(folder / "unnamed.csv"), ["does not name its machine", "# machine_type:", "machine ="]),
    (lambda folder: furcula.read_log(folder / "unnamed.csv", machine="hoper"), ["hoper", "did you mean", "hopper"]),
    (lambda folder: furcula.read_log(folder / "unnamed.csv", map=folder / "none.toml"), ["none.toml"]),
    (lambda folder: furcula.make_log({"angle_rad": [1.0]}, "rotary_joint"), ["no column time_s"]),
    (lambda folder: furcula.make_log({"time_s": [0.0, 1.0], "angle_rad": [1.0], "torque_nm": [0, 0]}, "rotary_joint"),
     ["'angle_rad' has 1 rows; expected 2"]),
    (lambda folder: furcula.make_log({"time_s": [[0.0, 1.0]]}, "rotary_joint"), ["2 dimensions", "expected one"]),
    (lambda folder: furcula.make_log({"time_s": [0.0, 0.1], "angle_rad": [1.0, np.nan], "torque_nm": [0, 0]}, "rotary_joint"),
     ["'angle_rad', index 1", "expected finite"]),
])
def test_a_log_that_cannot_be_read_is_one_error(tmp_path, call, words):
    (tmp_path / "unnamed.csv").write_text("time_s,angle_rad,torque_nm\n0,0,0\n0.1,0,0\n")
    with pytest.raises(furcula.Error) as error:
        call(tmp_path)
    assert isinstance(error.value, ValueError)
    for word in words:
        assert word in str(error.value)


def test_names_of_files_need_not_be_text(tmp_path, arm_logs):
    name = os.fsdecode(bytes(tmp_path) + b"/run\xff.csv")
    with pytest.raises(furcula.Error, match="run\ufffd.csv"):
        furcula.read_log(name)
    arm_logs[0].write(name)
    log = furcula.read_log(name)
    assert log.path == name
    assert len(log) == len(arm_logs[0])
    assert "run" in repr(log)


def test_a_column_that_is_not_there_names_those_that_are(arm_logs):
    with pytest.raises(KeyError, match="angle_elbow_rad"):
        arm_logs[0]["angle_elbow"]
