// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "glissade/base/status.h"

/// \file
/// A run as one HTML file that needs nothing else, no network either: headline figures, the
/// trajectory in 3-D, errors and biases with their bands, times, events, tracks over thumbnails.
/// Drawn by plotly.js, which goes into the page whole.
///
/// What the page is made of (JSON; columns, one entry a frame). Everything may be absent, null or
/// empty: the page then says what it was not given. NaN and Inf become null, "not known". Units: m,
/// s, m/s, m/s^2, rad/s, ms; times `t` count from the first frame of the recording (any origin
/// does, one for the whole page).
///
///     title            "MH_05, mono": what was run
///     origin           the folder or file it ran on
///     app_version      "vio_run 0.1.0": what made it; its first line is shown
///     trajectory_only  true: there was no run, so that nothing is said of what it does not have
///     figures          {...}: the keys of vio_replay --json (ate_m, rpe_percent, median_ms, ...);
///                      besides them duration_s, frames_dropped
///     sigma_meaning    "seen from the window's oldest frame": what the sigmas are relative to
///     camera_period_ms time from image to image
///     states           {t: [n], p: [n][3], q: [n][4] (x y z w), v: [n][3], ba: [n][3], bg: [n][3],
///                      sigma_p, sigma_v, sigma_ba, sigma_bg, error_p: [n][3]}: T_W_B of the newest
///                      frame, as known then; one sigma along each axis; error_p: the error that
///                      sigma_p is about, where that is not estimate minus truth (see
///                      sigma_meaning)
///     truth            {t: [m], p: [m][3]}: on the clock of the states, aligned to them already
///     landmarks        [l][3] or [l][4]: x, y, z in W and, if given, how many frames have seen it
///     stages           {t: [n], names: [s], ms: [s][n], total: [n]}: stages that do not overlap;
///                      without `total` a frame takes their sum
///     features         {t: [n], count: [n], age: [n], landmarks: [n]}: features of the newest
///     image,
///                      the median of their ages (frames), landmarks in the window
///     events           [{t, what, count}]: at which frame, "observation rejected", how many
///     event_counts     {what: count}: over the whole run, besides those of figures.events
///     thumbnails       [{t, width, height, scale, jpeg, tracks}]: width and height in pixels of
///     the
///                      JPEG, which is `scale` times as large as the image; jpeg in base64; tracks
///                      [[age, [x0, y0, x1, y1, ...]], ...], newest place last, in pixels of the
///                      image (not of the thumbnail)
namespace glissade::app {

/// Whether pages can be written here: plotly.min.js is looked for in share/glissade beside the
/// folder of the program, or is the file that the environment's GLISSADE_PLOTLY_JS names. To be
/// asked before a long run. kIoError, in one line that says what to do.
Status CheckReportPage();

/// Writes the page; the file appears whole or not at all ("-": on standard output). Fails as
/// CheckReportPage() does, if `data` is no object (kInvalidArgument), or as files fail (kIoError).
Status WriteReportPage(const nlohmann::ordered_json& data, const std::string& file);

/// Base64 (RFC 4648, with padding): what `jpeg` holds.
std::string ToBase64(std::string_view bytes);

}  // namespace glissade::app
