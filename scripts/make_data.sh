#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# make_data.sh [FOLDER_OF_THE_EXECUTABLES [OUTPUT_FOLDER]]
#
# Makes the data of data/ anew (data/course_scene.txt apart, which is frozen). Default: the release
# build, into data/.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
bin=${1:-build/release/bin}
to=${2:-data}
mkdir -p "$to"
"$bin/make_data" windows "$to/win10.txt.gz" --keyframes 10 --windows 3 --seed 101
"$bin/make_data" windows "$to/win11m.txt.gz" --keyframes 11 --windows 1 --hosted-by-first 60 --seed 111
"$bin/make_data" recording "$to/flight" --seed 1
"$bin/make_data" odometry "$to/flight_odometry.txt.gz" --seed 1
"$bin/make_data" bal "$to/ring.txt.gz" --seed 1
