#!/usr/bin/env bash
# Drops on concrete: wear is energy, and linear in what brings energy.
set -euo pipefail
program="$1"
failures=0

fail() { echo "FAILED: $*"; failures=$((failures + 1)); }
value() { grep -oE "\"$1\": *[^,}]*" out/02_drop_on_concrete/summary.json | head -1 | sed 's/.*: *//'; }
holds() { awk "BEGIN { exit !($2) }" || fail "$1: $2"; } # NAME EXPRESSION, with awk's syntax

"$program" > run.log 2>&1 || { echo "FAILED: $(cat run.log)"; exit 1; }
for file in worn_against_height.png worn_against_mass.png worn_against_drops.png energy_shares.png; do
    [ -s "out/02_drop_on_concrete/$file" ] || fail "$file is missing or empty"
done

# Sums of some thousand increments.
holds "worn is energy" "$(value worn_volume_error_relative) < 1e-12"
holds "no overflow" "$(value max_fracture_rate) < 1"
[ "$(value bonds_broken)" = 0 ] || fail "bonds broke"
# The sphere falls on while it sinks in: 0.29 mm of 50 mm, 0.6 % of the loss.
holds "rigid concrete, closed form" "$(value rigid_worn_volume_error_relative) < 0.006"
# The same push makes the low drops lose a little more: 0.4 % over a decade of height.
for x in height mass; do
    for on in rigid bonded; do holds "linear in $x, $on" "($(value exponent_${x}_$on) - 1)^2 < 0.005^2"; done
done
# beta and the number of drops change nothing in the motion; waves of the drop before are 1e-9 of a drop.
for x in rigid bonded; do holds "linear in beta, $x" "($(value exponent_beta_$x) - 1)^2 < 1e-9^2"; done
holds "linear in drops" "$(value departure_from_line_drops_relative) < 1e-6"
# Where the energy went: all of it, up to the integrator's error, which is shown.
brought=$(value energy_brought_J)
sum="$(value energy_lost_in_contact_J) + $(value energy_lost_in_bonds_J) + $(value energy_rebound_J) + $(value energy_left_in_slab_J) + $(value integration_residue_J)"
holds "energy balance" "($sum - $brought)^2 < (1e-10 * $brought)^2"
holds "small residue" "($(value integration_residue_J))^2 < (1e-4 * $brought)^2"
holds "stiff bonds take little" "$(value share_lost_in_bonds) > 1e-4 && $(value share_lost_in_bonds) < 0.005"
holds "on stiff bonds nearly as on rigid concrete" \
    "$(value worn_volume_mm3) > 0.97 * $(value rigid_worn_volume_mm3)"
holds "less in the contact than on rigid concrete" "$(value share_lost_in_contact) < 1 - $(value restitution)^2"
# A dashpot knows the mass of the sphere that is hit, and wear then does not grow as the stone's mass.
holds "dashpot on a stiff slab" \
    "($(value share_lost_in_contact_dashpot) / $(value share_lost_in_contact_dashpot_theory) - 1)^2 < 0.05^2"
holds "dashpot: not linear in mass" "$(value exponent_mass_dashpot) < 0.7"
holds "ledger" "$(value ledger_residual_relative) < 1e-11"

[ $failures -eq 0 ] && echo "drop on concrete: wear is energy"
exit $((failures > 0))
