#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# window_table.sh [--write] [FOLDER_OF_THE_EXECUTABLES]
#
# Policies x recordings, and the batch solution: the table of docs/windows.md, printed, or with --write put in its place there.
# The recordings are those of $GLISSADE_DATA/vio; those that are not there have no rows. Times are of the
# thread's own clock, one thread. RESULTS=FOLDER keeps the JSON files of vio_replay (and uses those that
# are there already).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
write=0
if [[ ${1:-} == --write ]]; then
  write=1
  shift
fi
bin=${1:-build/release/bin}
data=${GLISSADE_DATA:-../shared/data}
if [[ -n ${RESULTS:-} ]]; then
  results=$RESULTS
  mkdir -p "$results"
else
  results=$(mktemp -d)
  trap 'rm -rf "$results"' EXIT
fi

# Name of the row, folder, options.
runs=(
  "EuRoC V1_01, stereo|euroc_v101_map|"
  "EuRoC V1_01, mono|euroc_v101_map|--mono"
  "EuRoC MH_05, stereo|euroc_mh05_map|"
  "EuRoC MH_05, mono|euroc_mh05_map|--mono"
  "KITTI 09_30_0020, stereo, no IMU|kitti_0930_0020|"
  "Malaga parking 6L, mono|malaga_parking6L|--mono --time-offset -0.11"
)
policies=(okvis vins basalt lag)

# A line of the table.
row() {
  python3 - "$@" <<'PYTHON'
import json
import sys

name, policy, path = sys.argv[1:]
with open(path, encoding="utf-8") as file:
    run = json.load(file)
r = run["batch"] if policy == "batch" else run


def show(key, digits):
    return "-" if r[key] is None else f"{r[key]:.{digits}f}"


# The truth of Malaga has another vertical than the window's.
ate_key = "ate_se3_m" if name.startswith("Malaga") else "ate_m"
ate = "-" if r[ate_key] is None else f"{r[ate_key]:.3g}"
line = (f"| {name} | {policy} | {ate} | {show('rpe_percent', 2)}, {r['rpe_length_m']:g} m | "
        f"{show('yaw_drift_deg', 2)} | ")
if policy == "batch":
    print(f"{line}| | {r['left_out']} | {r['frames']} | | |")
else:
    c = r["consistency"]
    # Nor can its tilt be held against the window's.
    judged = c and not name.startswith("Malaga")
    nees = f"{c['nees_position']:.1f}, {c['nees_rotation']:.1f}" if judged else "-"
    print(f"{line}{r['median_ms']:.2f} / {r['p99_ms']:.2f} | {r['marginalize_median_ms']:.2f} | "
          f"{r['rejected']} | {r['window_frames_mean']:.1f} | {nees} | {r['window_mb']:.1f} |")
PYTHON
}

rows="| recording | policy | ATE [m] | RPE [%] over | yaw drift [deg] | ms per frame, median / 99 % | of it marginalization | rejected | frames in the window | NEES of position, rotation | MB |
|---|---|---|---|---|---|---|---|---|---|---|"
for run in "${runs[@]}"; do
  IFS='|' read -r name folder options <<<"$run"
  if [[ ! -d $data/vio/$folder ]]; then
    echo "$0: $data/vio/$folder is not there: left out" >&2
    continue
  fi
  for policy in "${policies[@]}"; do
    json="$results/${folder}_${policy}${options:+_mono}.json"
    # shellcheck disable=SC2086  # options are words
    [[ -f $json ]] || "$bin/vio_replay" "$data/vio/$folder" --policy "$policy" --consistency $options --json "$json" >/dev/null
    rows+=$'\n'$(row "$name" "$policy" "$json")
  done
  json="$results/${folder}_batch${options:+_mono}.json"
  # shellcheck disable=SC2086
  [[ -f $json ]] || "$bin/vio_replay" "$data/vio/$folder" --batch $options --json "$json" >/dev/null
  rows+=$'\n'$(row "$name" batch "$json")
done
if [[ $write == 0 ]]; then
  echo "$rows"
  exit
fi
if [[ $(wc -l <<<"$rows") -lt 3 ]]; then
  echo "$0: no recordings: docs/windows.md stays as it is" >&2
  exit
fi
ROWS=$rows python3 - <<'PYTHON'
import os
import pathlib
import re

path = pathlib.Path("docs/windows.md")
text = path.read_text(encoding="utf-8")
new, count = re.subn(r"(<!-- made by scripts/window_table.sh -->\n).*?(\n<!-- end -->)",
                     lambda m: m[1] + os.environ["ROWS"] + m[2], text, flags=re.DOTALL)
if count != 1:
    raise SystemExit("docs/windows.md: the place of the table is gone")
path.write_text(new, encoding="utf-8")
PYTHON
