// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "studies/gauge_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "common/output_file.h"
#include "glissade/eval/statistics.h"

namespace glissade::app {

namespace {

using eval::Quantile;
using Json = nlohmann::ordered_json;

Json SamplesToJson(const GaugeSamples& s) {
  return {{"p_m", Mean(s.position_m)},
          {"phi_deg", Mean(s.rotation_deg)},
          {"v_mps", Mean(s.velocity_mps)},
          {"iterations", Quantile(s.iterations, 0.5)},
          {"time_ms", Quantile(s.time_ms, 0.5)},
          {"iterations_quartiles", {Quantile(s.iterations, 0.25), Quantile(s.iterations, 0.75)}}};
}

Json AgreementToJson(const GaugeAgreement& a) {
  return {{"cost_relative", a.cost},
          {"position_m", a.states.position_m},
          {"rotation_rad", a.states.rotation_rad},
          {"velocity_mps", a.states.velocity_mps},
          {"iterations", a.iterations},
          {"converged", a.converged}};
}

Json MethodsToJson(const GaugeConfiguration& c) {
  Json methods = Json::object();
  for (const GaugeMethod method : kGaugeMethods)
    methods[ToString(method)] = SamplesToJson(c.methods[static_cast<int>(method)]);
  return methods;
}

/// log10(|s| + 1e-7), which is how the paper draws a covariance; three digits.
Json LogMatrix(const std::vector<double>& values, int size) {
  Json rows = Json::array();
  for (int i = 0; i < size; ++i) {
    Json row = Json::array();
    for (int j = 0; j < size; ++j) {
      const double s = values[static_cast<std::size_t>(i) * static_cast<std::size_t>(size) +
                              static_cast<std::size_t>(j)];
      row.push_back(std::round(1e3 * std::log10(std::abs(s) + 1e-7)) / 1e3);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

/// log10 of |a - b| as a part of what b's standard deviations allow; null where b holds a
/// coordinate.
Json LogDifference(const std::vector<double>& a, const std::vector<double>& b, int size) {
  const auto at = [size](int i, int j) {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(size) +
           static_cast<std::size_t>(j);
  };
  // Held: no variance but rounding.
  double largest = 0.0;
  for (int i = 0; i < size; ++i)
    largest = std::max(largest, b[at(i, i)]);
  Json rows = Json::array();
  for (int i = 0; i < size; ++i) {
    Json row = Json::array();
    for (int j = 0; j < size; ++j) {
      const double held = 1e-14 * largest;
      if (b[at(i, i)] <= held || b[at(j, j)] <= held) {
        row.push_back(nullptr);
        continue;
      }
      const double part =
          std::abs(a[at(i, j)] - b[at(i, j)]) / std::sqrt(b[at(i, i)] * b[at(j, j)]);
      row.push_back(std::round(1e3 * std::log10(part + 1e-20)) / 1e3);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

Json EllipsesToJson(const std::vector<GaugeEllipse>& ellipses) {
  Json list = Json::array();
  for (const GaugeEllipse& e : ellipses)
    list.push_back({e.x, e.y, e.xx, e.xy, e.yy});
  return list;
}

Json CovarianceToJson(const GaugeCovariances& c) {
  return {{"keyframes", c.keyframes},
          {"relative_error", c.relative_error},
          {"log10_free", LogMatrix(c.free, c.size)},
          {"log10_transformed", LogMatrix(c.transformed, c.size)},
          {"log10_fixed", LogMatrix(c.fixed, c.size)},
          {"log10_difference", LogDifference(c.transformed, c.fixed, c.size)},
          {"ellipses_x_y_xx_xy_yy",
           {{"free", EllipsesToJson(c.free_ellipses)},
            {"transformed", EllipsesToJson(c.transformed_ellipses)},
            {"fixed", EllipsesToJson(c.fixed_ellipses)}}}};
}

Json WithAgreement(Json json, const GaugeConfiguration& c) {
  json["converged"] = {{"free", AgreementToJson(c.free)}, {"prior", AgreementToJson(c.prior)}};
  return json;
}

void PrintMethods(const std::string& name, const GaugeConfiguration& c) {
  const GaugeSamples& fixed = c.methods[0];
  for (const GaugeMethod method : kGaugeMethods) {
    const GaugeSamples& s = c.methods[static_cast<int>(method)];
    const auto percent = [](double a, double b) { return 100.0 * (a - b) / b; };
    Print("{:<18} {:<6} {:>11.7f} {:>11.7f} {:>11.7f} {:>7.3f} {:>7.3f} {:>7.3f} {:>6g} {:>9.3f}\n",
          method == GaugeMethod::kFixed ? name : "", ToString(method), Mean(s.position_m),
          Mean(s.rotation_deg), Mean(s.velocity_mps),
          percent(Mean(s.position_m), Mean(fixed.position_m)),
          percent(Mean(s.rotation_deg), Mean(fixed.rotation_deg)),
          percent(Mean(s.velocity_mps), Mean(fixed.velocity_mps)), Quantile(s.iterations, 0.5),
          Quantile(s.time_ms, 0.5));
  }
  const GaugeAgreement& a = c.free;
  Print("{:<18} converged, free against fixed: cost {:.1e}, {:.1e} m, {:.1e} rad, {:.1e} m/s\n", "",
        a.cost, a.states.position_m, a.states.rotation_rad, a.states.velocity_mps);
}

}  // namespace

void PrintStudy(const GaugeStudy& study) {
  Print("{:<18} {:<6} {:>11} {:>11} {:>11} {:>23} {:>6} {:>9}\n", "", "method", "p [m]",
        "phi [deg]", "v [m/s]", "against fixed [%]", "iter.", "time [ms]");
  for (const GaugeConfiguration& c : study.configurations)
    PrintMethods(c.trajectory + " " + c.points, c);
  if (!study.weights.empty()) {
    Print(
        "\nweights, {}; light: iterations with lambda_0 = {:g}; to the right: run until it "
        "converges, against fixed\n",
        study.sweep_configuration, kLightDamping);
    Print("{:>8} {:>12} {:>12} {:>12} {:>6} {:>9} {:>6}   {:>6} {:>8} {:>8} {:>8} {:>8}\n",
          "weight", "p [m]", "phi [deg]", "v [m/s]", "iter.", "time [ms]", "light", "iter.", "cost",
          "p [m]", "[rad]", "v [m/s]");
  }
  for (const GaugeWeight& w : study.weights) {
    const GaugeSamples& s = w.samples;
    const GaugeAgreement& a = w.agreement;
    Print(
        "{:>8g} {:>12.8f} {:>12.8f} {:>12.8f} {:>6g} {:>9.3f} {:>6g}   {:>6} {:>8.1e} "
        "{:>8.1e} {:>8.1e} {:>8.1e}\n",
        w.weight, Mean(s.position_m), Mean(s.rotation_deg), Mean(s.velocity_mps),
        Quantile(s.iterations, 0.5), Quantile(s.time_ms, 0.5), Quantile(w.light.iterations, 0.5),
        a.iterations, a.cost, a.states.position_m, a.states.rotation_rad, a.states.velocity_mps);
  }
  for (const GaugeCovariances& c : study.covariance) {
    Print("\ncovariance, {}, {} keyframes: transformed free against fixed {:.2e}\n",
          study.sweep_configuration, c.keyframes, c.relative_error);
  }
  for (const GaugeRealResult& r : study.real) {
    Print("\n");
    PrintMethods(r.dataset, r.configuration);
    Print("{:<18} covariance, {} keyframes: transformed free against fixed {:.2e}\n", "",
          r.covariance.keyframes, r.covariance.relative_error);
  }
}

Json ToJson(const GaugeStudy& study) {
  Json json = {{"trials", study.options.trials},
               {"seed", study.options.seed},
               {"prior_weight", study.options.prior_weight},
               {"sweep_configuration", study.sweep_configuration}};
  json["configurations"] = Json::array();
  for (const GaugeConfiguration& c : study.configurations) {
    json["configurations"].push_back(WithAgreement(
        {{"trajectory", c.trajectory}, {"points", c.points}, {"methods", MethodsToJson(c)}}, c));
  }
  json["weights"] = Json::array();
  for (const GaugeWeight& w : study.weights) {
    Json row = {{"weight", w.weight}};
    row.update(SamplesToJson(w.samples));
    row["light_damping"] = SamplesToJson(w.light);
    row["converged"] = AgreementToJson(w.agreement);
    json["weights"].push_back(std::move(row));
  }
  json["paths"] = Json::array();
  for (const GaugePath& path : study.paths) {
    Json steps = Json::array();
    for (const GaugeStep& s : path.steps) {
      steps.push_back({{"iteration", s.iteration},
                       {"reprojection_px", s.reprojection_px},
                       {"prior_position_m", s.prior_position_m},
                       {"prior_yaw_rad", s.prior_yaw_rad}});
    }
    json["paths"].push_back({{"weight", path.weight}, {"steps", std::move(steps)}});
  }
  json["covariance"] = study.covariance.empty() ? Json() : CovarianceToJson(study.covariance[0]);
  json["real"] = Json::array();
  for (const GaugeRealResult& r : study.real) {
    json["real"].push_back(WithAgreement({{"dataset", r.dataset},
                                          {"methods", MethodsToJson(r.configuration)},
                                          {"covariance", CovarianceToJson(r.covariance)}},
                                         r.configuration));
  }
  return json;
}

std::string ToCsv(const GaugeStudy& study) {
  std::string text = "set,method,weight,trial,p_m,phi_deg,v_mps,iterations,time_ms,cost\n";
  const auto rows = [&](const std::string& set, const char* method, double weight,
                        const GaugeSamples& s) {
    for (std::size_t k = 0; k < s.position_m.size(); ++k) {
      fmt::format_to(std::back_inserter(text),
                     "{},{},{:g},{},{:.17g},{:.17g},{:.17g},{},{:.6g},{:.17g}\n", set, method,
                     weight, k, s.position_m[k], s.rotation_deg[k], s.velocity_mps[k],
                     s.iterations[k], s.time_ms[k], s.cost[k]);
    }
  };
  const auto all_methods = [&](const std::string& set, const GaugeConfiguration& c) {
    for (const GaugeMethod method : kGaugeMethods) {
      rows(set, ToString(method), method == GaugeMethod::kPrior ? study.options.prior_weight : 0.0,
           c.methods[static_cast<int>(method)]);
    }
  };
  for (const GaugeConfiguration& c : study.configurations)
    all_methods(c.trajectory + " " + c.points, c);
  for (const GaugeWeight& w : study.weights)
    rows("weights " + study.sweep_configuration, "prior", w.weight, w.samples);
  for (const GaugeRealResult& r : study.real)
    all_methods(r.dataset, r.configuration);
  return text;
}

}  // namespace glissade::app
