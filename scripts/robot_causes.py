#!/usr/bin/env python3
# Causes that furcula_mujoco_robot plants, and what `furcula walk identify` calls them: for loop-study and walk-naming.
import shlex
import subprocess
import sys

CAUSES = ("coulomb", "viscous", "elasticity", "backlash", "delay", "payload", "slope", "slope_sideways", "sole", "friction", "encoder")
# A drive's damping and viscous friction brake a joint alike. Soles and the friction of the ground are not among the candidates.
NAMES = {"coulomb": ("coulomb_friction",), "viscous": ("viscous_friction", "gain_kd"), "elasticity": ("gear_elasticity",), "backlash": ("backlash",),
         "delay": ("command_delay",), "payload": ("mass", "centre"), "slope": ("slope_y",), "slope_sideways": ("slope_x",), "sole": (),
         "friction": (), "encoder": ("encoder_offset",)}


def run(command, fine=(0,)):
    """What the command prints; ends the program where its status is another one."""
    ended = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if ended.returncode not in fine:
        sys.exit(f"{sys.argv[0]}: {shlex.join(map(str, command))}: status {ended.returncode}: {ended.stderr.strip()}")
    return ended.stdout
