#include "tools/samples/creature.hpp"

#include <algorithm>
#include <cmath>

#include "core/index.hpp"

namespace crosspatch {
namespace {

/// Adds a chain of limbs through `nodes` with a radius each.
void chain(Creature& c,
           Part part,
           const std::vector<Vector3d>& nodes,
           const std::vector<double>& radii,
           double blend) {
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i)
    c.limbs.push_back({part, nodes[i], nodes[i + 1], radii[i], radii[i + 1], blend});
}

double distance_to(const Limb& limb, const Vector3d& p) {
  const Vector3d axis = limb.b - limb.a;
  const double t = std::clamp((p - limb.a).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  return (p - limb.a - t * axis).norm() - (1 - t) * limb.radius_a - t * limb.radius_b;
}

/// Minimum of a and b, rounded off where they differ by less than `width` (quadratic blend).
double smooth_minimum(double a, double b, double width) {
  const double h = std::max(width - std::abs(a - b), 0.0) / width;
  return std::min(a, b) - h * h * width / 4;
}

}  // namespace

Creature make_lira() {
  Creature c;
  c.name = "lira";
  chain(c, Part::kBody, {{0, .86, -.42}, {.01, .84, 0}, {0, .90, .40}}, {.17, .165, .20}, .10);
  chain(c, Part::kHead, {{0, .95, .48}, {.03, 1.15, .62}, {.05, 1.24, .72}}, {.13, .10, .135}, .08);
  chain(c, Part::kHead, {{.05, 1.23, .76}, {.085, 1.15, 1.02}}, {.11, .045}, .06);
  chain(c, Part::kEar, {{.12, 1.33, .69}, {.20, 1.60, .66}}, {.055, .03}, .04);
  chain(c, Part::kEar, {{-.03, 1.33, .68}, {-.11, 1.58, .58}}, {.055, .03}, .04);
  chain(c,
        Part::kTail,
        {{0, .92, -.52}, {-.03, 1.05, -.78}, {-.09, 1.28, -.98}, {-.14, 1.46, -1.22}},
        {.08, .075, .085, .03},
        .06);
  chain(c,
        Part::kFrontLeg,
        {{.12, .80, .38}, {.14, .42, .44}, {.145, .07, .52}},
        {.10, .06, .055},
        .07);
  chain(c,
        Part::kFrontLeg,
        {{-.12, .80, .36}, {-.14, .42, .32}, {-.15, .07, .24}},
        {.10, .06, .055},
        .07);
  chain(c,
        Part::kHindLeg,
        {{.11, .78, -.42}, {.14, .46, -.34}, {.14, .07, -.46}},
        {.12, .07, .055},
        .07);
  chain(c,
        Part::kHindLeg,
        {{-.11, .78, -.44}, {-.14, .46, -.52}, {-.15, .07, -.70}},
        {.12, .07, .055},
        .07);
  c.eyes = {{.155, 1.29, .80}, {-.035, 1.29, .82}};
  c.eye_radius = .05;
  c.nose = {.087, 1.15, 1.06};
  c.nose_radius = .05;
  c.tail_tip = {-.15, 1.49, -1.25};
  c.sock_height = .26;
  return c;
}

Creature make_bodo() {
  Creature c;
  c.name = "bodo";
  chain(c, Part::kBody, {{0, .56, -.55}, {0, .54, -.05}, {0, .58, .42}}, {.30, .36, .28}, .14);
  chain(c, Part::kHead, {{0, .66, .60}, {-.06, .72, .88}}, {.22, .24}, .12);
  chain(c, Part::kHead, {{-.07, .66, 1.02}, {-.11, .50, 1.30}}, {.17, .09}, .08);
  chain(c, Part::kEar, {{.12, .90, .82}, {.27, 1.03, .78}}, {.065, .05}, .05);
  chain(c, Part::kEar, {{-.22, .90, .84}, {-.36, 1.02, .84}}, {.065, .05}, .05);
  chain(c,
        Part::kTail,
        {{0, .68, -.80}, {.05, .74, -1.00}, {.12, .68, -1.18}},
        {.09, .07, .045},
        .06);
  chain(c, Part::kFrontLeg, {{.22, .42, .40}, {.25, .10, .50}}, {.14, .10}, .08);
  chain(c, Part::kFrontLeg, {{-.22, .42, .36}, {-.25, .10, .28}}, {.14, .10}, .08);
  chain(c, Part::kHindLeg, {{.22, .42, -.54}, {.26, .10, -.66}}, {.16, .105}, .08);
  chain(c, Part::kHindLeg, {{-.22, .42, -.50}, {-.26, .10, -.42}}, {.16, .105}, .08);
  c.eyes = {{.14, .80, 1.01}, {-.27, .80, 1.02}};
  c.eye_radius = .06;
  c.nose = {-.12, .48, 1.37};
  c.nose_radius = .08;
  c.tail_tip = {.14, .67, -1.22};
  c.sock_height = .17;
  return c;
}

Creature make_tola() {
  Creature c;
  c.name = "tola";
  chain(c, Part::kBody, {{0, 1.05, -.38}, {0, 1.08, 0}, {0, 1.12, .34}}, {.21, .24, .23}, .12);
  chain(
      c, Part::kHead, {{0, 1.22, .44}, {.01, 1.46, .60}, {.04, 1.68, .68}}, {.16, .10, .125}, .08);
  chain(c, Part::kHead, {{.05, 1.68, .74}, {.11, 1.56, 1.06}}, {.115, .055}, .06);
  chain(c, Part::kEar, {{.12, 1.78, .66}, {.25, 2.00, .60}}, {.055, .035}, .04);
  chain(c, Part::kEar, {{-.04, 1.78, .64}, {-.15, 2.01, .56}}, {.055, .035}, .04);
  chain(c,
        Part::kTail,
        {{0, 1.14, -.56}, {.03, 1.02, -.80}, {.08, .78, -1.00}, {.12, .60, -1.16}},
        {.075, .055, .055, .04},
        .05);
  chain(c,
        Part::kFrontLeg,
        {{.14, .95, .34}, {.16, .52, .30}, {.17, .07, .26}},
        {.12, .07, .065},
        .07);
  chain(c,
        Part::kFrontLeg,
        {{-.14, .95, .36}, {-.16, .52, .42}, {-.17, .07, .50}},
        {.12, .07, .065},
        .07);
  chain(c,
        Part::kHindLeg,
        {{.14, .92, -.38}, {.17, .52, -.46}, {.17, .07, -.58}},
        {.14, .08, .065},
        .07);
  chain(c,
        Part::kHindLeg,
        {{-.14, .92, -.36}, {-.17, .52, -.32}, {-.17, .07, -.28}},
        {.14, .08, .065},
        .07);
  return c;
}

double skin_distance(const Creature& creature, const Vector3d& p) {
  double d = distance_to(creature.limbs.front(), p);
  for (std::size_t i = 1; i < creature.limbs.size(); ++i)
    d = smooth_minimum(d, distance_to(creature.limbs[i], p), creature.limbs[i].blend);
  return d;
}

int nearest_limb(const Creature& creature, const Vector3d& p) {
  int best = 0;
  double least = distance_to(creature.limbs.front(), p);
  for (int i = 1; i < static_cast<int>(creature.limbs.size()); ++i) {
    const double d = distance_to(creature.limbs[idx(i)], p);
    if (d >= least) continue;
    least = d;
    best = i;
  }
  return best;
}

}  // namespace crosspatch
