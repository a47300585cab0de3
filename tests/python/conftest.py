# What the tests of the Python package share: robots, logs, and the program `furcula` of the same build.
import math
import os
import pathlib
import subprocess

import furcula
import pytest

SOURCE = pathlib.Path(__file__).resolve().parents[2]

# Two rods in a vertical plane; centres of mass halfway. Numbers are those of the closed forms in test_dynamics.py.
ARM = dict(m1=1.2, m2=0.7, l1=0.4, l2=0.3, i1=0.02, i2=0.008)
ARM_URDF = """<robot name="arm">
  <link name="base"/>
  <link name="upper"><inertial><origin xyz="0 0 -{c1}"/><mass value="{m1}"/>
    <inertia ixx="{i1}" ixy="0" ixz="0" iyy="{i1}" iyz="0" izz="0.001"/></inertial></link>
  <link name="lower"><inertial><origin xyz="0 0 -{c2}"/><mass value="{m2}"/>
    <inertia ixx="{i2}" ixy="0" ixz="0" iyy="{i2}" iyz="0" izz="0.001"/></inertial></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
    <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="20" velocity="10"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/>
    <origin xyz="0 0 -{l1}"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="20" velocity="10"/></joint>
</robot>""".format(c1=ARM["l1"] / 2, c2=ARM["l2"] / 2, **ARM)
ARM_TOML = '[model]\nkind = "tree"\nschema = 1\nurdf = "arm.urdf"\n[drive]\ncontrol_mode = "torque"\n'
FRICTION = "[effect.coulomb_friction.elbow]\ntorque_nm = 0.08\n"
SCENARIO = "[run]\nduration_s = 6.0\n"

JOINT_TOML = """[model]
kind = "rotary_joint"
schema = 1
[parameters]
inertia_kgm2 = 0.15
gravity_torque_nm = 2.6
damping_nmspr = {damping}
[free]
damping_nmspr = [0.0, 1.0]
"""


@pytest.fixture(scope="session")
def arm():
    return furcula.parse_model(ARM_TOML, urdf=ARM_URDF)


@pytest.fixture(scope="session")
def arm_logs():
    """Of an arm whose elbow has dry friction that the model does not have."""
    real = furcula.parse_model(ARM_TOML + FRICTION, urdf=ARM_URDF)
    return [furcula.simulate(real, scenario_toml=SCENARIO, seed=seed) for seed in range(4)]


@pytest.fixture(scope="session")
def arm_folder(tmp_path_factory, arm_logs):
    """The same as files."""
    folder = tmp_path_factory.mktemp("arm")
    (folder / "arm.urdf").write_text(ARM_URDF)
    (folder / "arm.toml").write_text(ARM_TOML)
    for i, log in enumerate(arm_logs):
        log.write(folder / f"run{i}.csv")
    return folder


@pytest.fixture(scope="session")
def program():
    path = os.environ.get("FURCULA_PROGRAM", str(SOURCE / "build/dev/bin/furcula"))
    if not os.path.exists(path):
        pytest.skip(f"the program {path} is not built")

    def run(*arguments, status=0):
        ran = subprocess.run([path, *map(str, arguments)], capture_output=True, text=True, check=False)
        assert ran.returncode == status, ran.stderr
        return ran

    return run


def elliptic_period_s(length_m, gravity_mps2, amplitude_rad):
    """Of a pendulum: 2 pi sqrt(l/g) over the arithmetic-geometric mean of 1 and cos(amplitude/2)."""
    a, b = 1.0, math.cos(amplitude_rad / 2)
    while abs(a - b) > 1e-15:
        a, b = (a + b) / 2, math.sqrt(a * b)
    return 2 * math.pi * math.sqrt(length_m / gravity_mps2) / a
