#!/bin/sh
# Remakes the pictures of README.md from figures of the scenarios. `springpot` must be found in PATH.
set -eu
cd "$(dirname "$0")"
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
rm -rf pictures
mkdir pictures
while read -r scenario figure; do
    springpot run "$scenario.toml" --out "$results/$scenario" --quiet
    cp "$results/$scenario/figures/$figure.svg" "pictures/$scenario.svg"
done <<FIGURES
thermoviscoelastic_temperature temperature
piezo_voltage voltage
magnetorheological_voltage hysteresis
falling_thermoviscoelastic fall
panda_strut_and_strap strap
panda_gripper_path elbow
piezo_cancels place
spencer_sine force_over_velocity
piezo_stack stroke
mr_damper force
ur5_mount elbow
tendon_finger tension
foam_pad settling
foam_pad_temperature force
warm_mount loops_warming
filled_mount loops
torsional_coupling loop
bumper loop
one_mass_exact motion
expansion_scheme force
flyball_governor robot
flyball_governor_zener couplers
FIGURES
