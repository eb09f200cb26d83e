// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "glissade/base/status.h"

namespace glissade::app {

/// What --version prints: version, instruction sets compiled in and the one in use, compiler,
/// options and packages of the build.
std::string VersionText(const std::string& app);

/// What every JSON file of the apps begins with: "schema" ("glissade/APP/1", its number grows when
/// a key changes its meaning or goes), "version", "isa", "file" (null where nothing was read) and
/// "interrupted" (the work was ended by Ctrl-C: what follows is what there was until then). Units
/// are the ends of the names of keys; costs, weights in sigmas and ratios have none.
nlohmann::ordered_json JsonHeader(const std::string& app, const std::string& file);

/// Writes it to a file or, for "-", to standard output. An indent of -1: in one line.
Status WriteJson(const std::string& path, const nlohmann::ordered_json& json, int indent);

}  // namespace glissade::app
