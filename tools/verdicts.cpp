#include "tools/verdicts.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "tools/pipeline.hpp"

namespace crosspatch {
namespace {

struct Band {
  double good, fair;  ///< bounds of the first two levels; beyond the second it is poor
};

/// Level 0, 1 or 2 of a value of which less is better.
int level(double value, const Band& band) {
  if (value <= band.good) return 0;
  return value <= band.fair ? 1 : 2;
}

constexpr const char* kLevels[] = {"good", "fair", "poor"};

}  // namespace

std::vector<FigureVerdict> verdicts(const std::map<std::string, double>& quality) {
  std::vector<FigureVerdict> result;
  const auto add = [&](const char* key,
                       const char* name,
                       auto value,
                       auto judge,
                       const std::array<const char*, 3>& texts) {
    const auto found = quality.find(key);
    if (found == quality.end()) return;
    const int l = judge(found->second);
    result.push_back({name, value(found->second), kLevels[l], texts[static_cast<std::size_t>(l)]});
  };
  const auto number = [](double v) { return fmt::format("{:.3g}", v); };
  const auto percent = [](double v) { return fmt::format("{:.2f} %", 100 * v); };
  const auto lack = [](const Band& band) {
    return [band](double v) { return level(1 - v, band); };
  };
  const auto less = [](const Band& band) { return [band](double v) { return level(v, band); }; };
  add("confidence",
      "Confidence",
      percent,
      [](double v) { return v >= 1 ? 0 : (v >= 1.0 / 3 ? 1 : 2); },
      {"The choice is clear and no part is crumpled: the map can be trusted.",
       "Look at it first: the choice of the map or its distortion, below, is not safe.",
       "Look closely: the choice of the map or its distortion, below, is far from safe."});
  add(
      "margin",
      "Margin over the next best map",
      [](double v) { return std::isfinite(v) ? fmt::format("{:.3f}", v) : "no other map"; },
      [](double v) { return v >= kSafeMargin ? 0 : (v >= kSafeMargin / 3 ? 1 : 2); },
      {"No other way to see it comes close: left, right, front and back can be trusted.",
       "Another way to see it is not much worse. Look whether left and right are right.",
       "Another way to see it is about as good. Look closely; one or two landmarks settle it."});
  add("flipped_triangles",
      "Pieces turned over",
      number,
      less({0, 0}),
      {"None: the map is one-to-one everywhere.", "", "There the texture would show inside out."});
  add("coverage",
      "Target covered",
      percent,
      lack({1e-6, 0.1}),
      {"Every place has a counterpart.",
       "Holes of the source leave some places without a counterpart; they are grey.",
       "Large parts have no counterpart; they are grey."});
  add("symmetric_dirichlet_median",
      "Distortion, half of the surface below",
      number,
      less({5, 8}),
      {"The typical place is hardly stretched (4 is none at all).",
       "The typical place is stretched, as between bodies of different build.",
       "The typical place is stretched a lot: do the two have the same limbs?"});
  add("symmetric_dirichlet_90",
      "Distortion, nine tenths below",
      number,
      less({10, 30}),
      {"Few places are stretched much.",
       "Some parts, such as ears or hands, are stretched.",
       "Whole parts are stretched: perhaps one of the two lacks them."});
  add("symmetric_dirichlet_99",
      "Distortion, 99 of 100 below",
      number,
      less({kSafeEnergy, 3 * kSafeEnergy}),
      {"No part is crumpled.",
       "A part is crumpled: perhaps the other surface lacks it.",
       "Parts are crumpled: the two may not correspond there."});
  add("texels_filled",
      "Texels filled",
      percent,
      lack({0, 1e-3}),
      {"No place of the target is left without colour.",
       "Single texels are left without colour.",
       "Some places are left without colour."});
  add("seam_error_mip_3",
      "Seams, seen from afar",
      [](double v) { return fmt::format("{:.1f} of 255", v); },
      less({4, 12}),
      {"They cannot be seen.",
       "Faint lines may be seen along them.",
       "They can be seen as lines."});
  add(
      "round_trip_psnr",
      "There and back",
      [](double v) { return fmt::format("{:.1f} dB", v); },
      [](double v) { return v >= 32 ? 0 : (v >= 26 ? 1 : 2); },
      {"Hardly a detail of the texture was lost.",
       "Fine details were lost: larger images keep more.",
       "Much was lost: larger images keep more, but where the map presses a part together they "
       "help little."});
  return result;
}

}  // namespace crosspatch
