# Dynamics of arrays against closed forms.
import numpy as np
import pytest

import furcula
from conftest import ARM, ARM_TOML, ARM_URDF, JOINT_TOML, SOURCE, elliptic_period_s

RNG = np.random.default_rng(3)
Q, QD, QDD = (RNG.uniform(-2, 2, (200, 2)) for _ in range(3))
G = 9.81


def closed_form():
    """Mass matrix, Coriolis and gravity of two rods; q = 0 hangs down. Positions of the joints about +y."""
    m1, m2, l1, i1, i2 = (ARM[k] for k in ("m1", "m2", "l1", "i1", "i2"))
    c1, c2 = ARM["l1"] / 2, ARM["l2"] / 2
    q1, q2, v1, v2 = Q[:, 0], Q[:, 1], QD[:, 0], QD[:, 1]
    m22 = np.full_like(q1, i2 + m2 * c2**2)
    m12 = m22 + m2 * l1 * c2 * np.cos(q2)
    m11 = i1 + m1 * c1**2 + m2 * l1**2 + m22 + 2 * m2 * l1 * c2 * np.cos(q2)
    h = m2 * l1 * c2 * np.sin(q2)
    g2 = m2 * c2 * G * np.sin(q1 + q2)
    g1 = (m1 * c1 + m2 * l1) * G * np.sin(q1) + g2
    bias = np.stack([-h * (2 * v1 * v2 + v2**2) + g1, h * v1**2 + g2], axis=1)
    return np.stack([np.stack([m11, m12], 1), np.stack([m12, m22], 1)], 1), bias


def test_the_mass_matrix_of_a_double_pendulum_is_the_closed_form(arm):
    mass, _ = closed_form()
    found = furcula.mass_matrix(arm, Q)
    assert found.shape == (200, 2, 2)
    np.testing.assert_allclose(found, mass, atol=1e-13)


def test_bias_forces_and_inverse_dynamics_of_a_double_pendulum_are_the_closed_form(arm):
    mass, bias = closed_form()
    np.testing.assert_allclose(furcula.bias_forces(arm, Q, QD), bias, atol=1e-12)
    torque = np.einsum("nij,nj->ni", mass, QDD) + bias
    np.testing.assert_allclose(furcula.inverse_dynamics(arm, Q, QD, QDD), torque, atol=1e-12)


def test_forward_dynamics_gives_back_the_accelerations(arm):
    torque = furcula.inverse_dynamics(arm, Q, QD, QDD)
    np.testing.assert_allclose(furcula.forward_dynamics(arm, Q, QD, torque), QDD, atol=1e-9)


def test_rotors_and_damping_of_the_model_file_are_in_the_dynamics():
    text = ARM_TOML + "rotor_inertia_kgm2 = 0.05\ndamping_nmspr = 0.3\n"
    with_drive = furcula.parse_model(text, urdf=ARM_URDF)
    mass, bias = closed_form()
    torque = np.einsum("nij,nj->ni", mass + 0.05 * np.eye(2), QDD) + bias + 0.3 * QD
    np.testing.assert_allclose(furcula.inverse_dynamics(with_drive, Q, QD, QDD), torque, atol=1e-12)


def test_one_state_and_a_state_for_all_rows(arm):
    whole = furcula.inverse_dynamics(arm, Q, QD, QDD)
    assert furcula.inverse_dynamics(arm, Q[5], QD[5], QDD[5]) == pytest.approx(whole[5], abs=1e-15)
    still = furcula.inverse_dynamics(arm, Q, [0, 0], [0, 0])
    np.testing.assert_array_equal(still, furcula.inverse_dynamics(arm, Q, 0 * Q, 0 * Q))
    assert furcula.inverse_dynamics(arm, np.empty((0, 2)), [0, 0], [0, 0]).shape == (0, 2)
    np.testing.assert_array_equal(furcula.mass_matrix(arm, np.asfortranarray(Q)), furcula.mass_matrix(arm, Q))


def test_power_of_the_torques_is_the_rate_of_the_energy(arm):
    step_s = 1e-6
    before = furcula.energy(arm, Q - step_s * QD, QD - step_s * QDD).sum(axis=1)
    after = furcula.energy(arm, Q + step_s * QD, QD + step_s * QDD).sum(axis=1)
    power = (furcula.inverse_dynamics(arm, Q, QD, QDD) * QD).sum(axis=1)
    np.testing.assert_allclose((after - before) / (2 * step_s), power, rtol=1e-6, atol=1e-6)


def test_the_biped_falls_freely_and_has_its_mass():
    biped = furcula.load_model(SOURCE / "models/biped/biped.toml")
    assert len(biped.joints) == 18
    q = np.zeros((3, 18))
    q[:, 6:] = RNG.uniform(-0.5, 0.5, (3, 12))
    mass = furcula.mass_matrix(biped, q)
    # The masses of models/biped/furcula_biped.urdf sum to 49.8 kg (document 000).
    for k in range(3):
        np.testing.assert_allclose(mass[k, :3, :3], 49.8 * np.eye(3), atol=1e-12)
    fall = furcula.forward_dynamics(biped, q, np.zeros(18), np.zeros(18))
    np.testing.assert_allclose(fall[:, :3], [[0, 0, -9.81]] * 3, atol=1e-12)
    np.testing.assert_allclose(fall[:, 3:], 0, atol=1e-10)


def test_a_pendulum_swings_with_the_period_of_the_elliptic_integral():
    # gravity_torque over inertia is g over the length of the simple pendulum.
    model = furcula.parse_model(JOINT_TOML.format(damping=0.0))
    log = furcula.simulate(model, scenario_toml='[start]\nangle_rad = 1.5\n[run]\nduration_s = 10.0\n[torque]\nprofile = "zero"\n')
    angle, time_s = log["angle_rad"], log.time_s
    falling = np.flatnonzero((angle[:-1] > 0) & (angle[1:] <= 0))
    crossings = time_s[falling] + 1e-3 * angle[falling] / (angle[falling] - angle[falling + 1])
    period_s = (crossings[-1] - crossings[0]) / (len(crossings) - 1)
    assert period_s == pytest.approx(elliptic_period_s(0.15 / 2.6, 1.0, 1.5), rel=1e-5)


@pytest.mark.parametrize("call, words", [
    (lambda m: furcula.mass_matrix(m, [0.0]), ["q has shape (1,)", "expected (2,) or (N, 2)"]),
    (lambda m: furcula.mass_matrix(m, np.zeros((2, 3, 2))), ["q has shape"]),
    (lambda m: furcula.inverse_dynamics(m, np.zeros((3, 2)), np.zeros((4, 2)), [0, 0]), ["qd has 4 rows", "expected 3, as q"]),
    (lambda m: furcula.mass_matrix(furcula.parse_model(JOINT_TOML.format(damping=0.0)), [0.0]), ["rotary_joint", "expected a tree"]),
])
def test_arrays_of_another_shape_are_refused(arm, call, words):
    with pytest.raises(furcula.Error) as error:
        call(arm)
    for word in words:
        assert word in str(error.value)


def test_a_spring_that_acts_both_ways_is_in_inverse_dynamics_and_energy():
    spring = '[spring.elbow]\nstiffness_nmprad = 4.0\nrest_rad = 0.2\nboth_ways = true\n'
    sprung = furcula.parse_model(ARM_TOML + spring, urdf=ARM_URDF)
    plain = furcula.parse_model(ARM_TOML, urdf=ARM_URDF)
    more = furcula.inverse_dynamics(sprung, Q, QD, QDD) - furcula.inverse_dynamics(plain, Q, QD, QDD)
    np.testing.assert_allclose(more[:, 0], 0.0, atol=1e-12)
    np.testing.assert_allclose(more[:, 1], 4.0 * (Q[:, 1] - 0.2), atol=1e-12)
    stored = furcula.energy(sprung, Q, QD)[:, 1] - furcula.energy(plain, Q, QD)[:, 1]
    np.testing.assert_allclose(stored, 2.0 * (Q[:, 1] - 0.2) ** 2, atol=1e-12)


def test_a_robot_file_is_a_tree(tmp_path):
    (tmp_path / "arm.urdf").write_text(ARM_URDF)
    assert furcula.load_model(tmp_path / "arm.urdf").kind == "tree"
