#include "param/predicates.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace crosspatch {
namespace {

using Rational = boost::multiprecision::cpp_rational;

int reference2d(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const Rational ax(a.x()), ay(a.y()), bx(b.x()), by(b.y()), cx(c.x()), cy(c.y());
  return Rational((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)).sign();
}

int reference_sphere(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  Rational det = 0;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    det += Rational(a[k]) * (Rational(b[i]) * Rational(c[j]) - Rational(b[j]) * Rational(c[i]));
  }
  return det.sign();
}

/// x moved by `steps` representable numbers.
double nudged(double x, int steps) {
  const double towards = steps > 0 ? HUGE_VAL : -HUGE_VAL;
  for (int i = 0; i < std::abs(steps); ++i) x = std::nextafter(x, towards);
  return x;
}

TEST(Predicates, Orient2dSignOfSimpleTriangles) {
  EXPECT_EQ(orient2d({0, 0}, {1, 0}, {0, 1}), 1);
  EXPECT_EQ(orient2d({0, 0}, {0, 1}, {1, 0}), -1);
  EXPECT_EQ(orient2d({0, 0}, {1, 1}, {3, 3}), 0);
  EXPECT_EQ(orient2d({2, 5}, {2, 5}, {7, -1}), 0);
}

TEST(Predicates, Orient2dMatchesRationalsAroundALine) {
  // The neighbourhood of a point of the line y = x, where doubles alone give random signs.
  const Vector2d b(12, 12), c(24, 24);
  for (int i = -8; i <= 8; ++i)
    for (int j = -8; j <= 8; ++j) {
      const Vector2d a(nudged(0.5, i), nudged(0.5, j));
      EXPECT_EQ(orient2d(a, b, c), reference2d(a, b, c));
      EXPECT_EQ(orient2d(a, b, c), (j > i) - (j < i));
    }
}

TEST(Predicates, Orient2dMatchesRationalsOnNearlyCollinearPoints) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::uniform_int_distribution<int> step(-2, 2), power(-300, 300);
  for (int i = 0; i < 3000; ++i) {
    const double scale = std::ldexp(1, power(random));
    const Vector2d a = scale * Vector2d(uniform(random), uniform(random));
    const Vector2d b = scale * Vector2d(uniform(random), uniform(random));
    Vector2d c = a + uniform(random) * (b - a);
    c = {nudged(c.x(), step(random)), nudged(c.y(), step(random))};
    const int expected = reference2d(a, b, c);
    EXPECT_EQ(orient2d(a, b, c), expected);
    EXPECT_EQ(orient2d(b, c, a), expected);
    EXPECT_EQ(orient2d(b, a, c), -expected);
  }
}

TEST(Predicates, Orient2dSurvivesOverflowAndUnderflow) {
  const double big = std::numeric_limits<double>::max(), tiny = 5e-324;
  const std::vector<double> values{0, tiny, -tiny, 3 * tiny, 1e-160, 1, 1e160, big, -big};
  std::mt19937_64 random(2);
  std::uniform_int_distribution<std::size_t> pick(0, values.size() - 1);
  const auto point = [&] { return Vector2d(values[pick(random)], values[pick(random)]); };
  for (int i = 0; i < 2000; ++i) {
    const Vector2d a = point(), b = point(), c = point();
    EXPECT_EQ(orient2d(a, b, c), reference2d(a, b, c))
        << a.transpose() << " / " << b.transpose() << " / " << c.transpose();
  }
}

TEST(Predicates, OrientSphereSignOfAxes) {
  const Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  EXPECT_EQ(orient_sphere(x, y, z), 1);
  EXPECT_EQ(orient_sphere(y, x, z), -1);
  EXPECT_EQ(orient_sphere(x, y, x + y), 0);
  EXPECT_EQ(orient_sphere(x, x, y), 0);
}

TEST(Predicates, OrientSphereMatchesRationalsNearGreatCircles) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::uniform_int_distribution<int> step(-2, 2), power(-300, 300);
  for (int i = 0; i < 3000; ++i) {
    const Vector3d a = Vector3d(normal(random), normal(random), normal(random)).normalized();
    const Vector3d b = Vector3d(normal(random), normal(random), normal(random)).normalized();
    Vector3d c = uniform(random) * a + uniform(random) * b;
    for (int k = 0; k < 3; ++k) c[k] = nudged(c[k], step(random));
    // Powers of two change no sign, but they reach the range where products under- and overflow.
    const Vector3d p = std::ldexp(1, power(random)) * a, q = std::ldexp(1, power(random)) * b;
    const Vector3d r = std::ldexp(1, power(random)) * c;
    const int expected = reference_sphere(a, b, c);
    EXPECT_EQ(orient_sphere(a, b, c), expected);
    EXPECT_EQ(orient_sphere(p, q, r), reference_sphere(p, q, r));
    EXPECT_EQ(orient_sphere(b, c, a), expected);
    EXPECT_EQ(orient_sphere(c, b, a), -expected);
  }
}

TEST(Predicates, OrientSphereSurvivesOverflowAndUnderflow) {
  const double big = std::numeric_limits<double>::max(), tiny = 5e-324;
  const std::vector<double> values{0, tiny, -tiny, 3 * tiny, 1e-110, 1, -1, 1e110, big, -big};
  std::mt19937_64 random(4);
  std::uniform_int_distribution<std::size_t> pick(0, values.size() - 1);
  const auto point = [&] {
    return Vector3d(values[pick(random)], values[pick(random)], values[pick(random)]);
  };
  for (int i = 0; i < 2000; ++i) {
    const Vector3d a = point(), b = point(), c = point();
    EXPECT_EQ(orient_sphere(a, b, c), reference_sphere(a, b, c));
  }
}

}  // namespace
}  // namespace crosspatch
