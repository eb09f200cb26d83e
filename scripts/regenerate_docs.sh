#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# regenerate_docs.sh [FOLDER_OF_THE_EXECUTABLES]
#
# Makes every picture of docs/images and every number of docs/figures.json anew, and writes them into
# the documents; `git diff` then shows what has changed. Times are left alone (docs/benchmarks.md has its
# own commands, for a quiet machine, and so have docs/large.md and its pictures, half an hour of bench_ba
# and scripts/plot_bench_ba.py), but for those of docs/windows.md, which are of the thread's own clock.
#
# Needs the programs (built with scripts/test.sh, or FOLDER with them) and a Python with matplotlib and the
# package glissade, from the build folder (GLISSADE_BUILD_PYTHON=ON) or installed (pip install ".[plot]");
# PYTHON=/path/to/venv/bin/python names another one than python3.
# The pictures of EuRoC recordings are made where GLISSADE_DATA names a folder with vio/euroc_v101_semi
# and vio/euroc_mh05_semi; without, they stay as they are.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
bin=${1:-build/release/bin}
python=${PYTHON:-python3}
package=$(dirname "$bin")/python
[[ -d $package/glissade ]] && export PYTHONPATH=$package${PYTHONPATH:+:$PYTHONPATH}
"$python" -c 'import glissade.plot' || {
  echo "$0: $python has no glissade.plot: pip install \".[plot]\", or build with GLISSADE_BUILD_PYTHON=ON" >&2
  exit 2
}
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT

scripts/check_docs_figures.py --bin "$bin" --results "$results" --write

"$python" scripts/plot_prior_weight.py "$results/sweep.json" "$results/course.json" \
  "$results/course_off.json" docs/images --path-weights 1e-4 0.01 0.1 1 10 1e8
"$python" scripts/plot_marginalization.py "$results/marginal.json" docs/images
"$python" scripts/plot_gauge_study.py "$results/study.json" docs/images

"$python" scripts/plot_hessian.py docs/images/mono_ba_hessian.png

# Only where GLISSADE_DATA has them: else their pictures and their table stay as they are.
if [[ -f $results/euroc.json ]]; then
  "$python" scripts/plot_gauge_study.py --recordings "$results/euroc.json" docs/images
fi

# Policies x recordings, and a run, where GLISSADE_DATA has them.
scripts/window_table.sh --write "$bin"
flight=${GLISSADE_DATA:-}/vio/euroc_v101_map
if [[ -d $flight ]]; then
  "$bin/vio_replay" "$flight" --states "$results/states.csv" >/dev/null
  "$python" scripts/plot_trajectory.py "$results/states.csv" "$flight" docs/images/window_euroc_v101.png
fi
# The front end on real images.
draw_run() { # RECORDING PICTURE
  [[ -d $1 && -x $bin/vio_run ]] || return 0
  "$bin/vio_run" "$1" --states "$results/states.csv" --save-tracks "$results/tracks" >/dev/null
  "$python" scripts/plot_trajectory.py "$results/states.csv" "$results/tracks" "$2"
  rm -r "$results/tracks"
}
draw_run "${GLISSADE_DATA:-}/images/euroc_mh05_cut" docs/images/front_end_mh05.png
draw_run "${GLISSADE_DATA:-}/images/kitti_cut1" docs/images/front_end_kitti.png
# A city before and after.
"$bin/make_data" city "$results/city.bbal" --cameras 1000 >/dev/null
"$bin/ba_solve" "$results/city.bbal" --linear-solver sparse --output "$results/solved.bbal" >/dev/null
"$python" scripts/plot_bal.py "$results/city.bbal" "$results/solved.bbal" docs/images/city_1000.png
git --no-pager diff --stat -- docs
