// From a surface to its spherical embedding, candidate maps, the optimised map and its exact
// overlay.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/progressive_mesh.hpp"
#include "param/chain_disc.hpp"
#include "param/judge.hpp"
#include "param/make_map.hpp"
#include "param/match.hpp"
#include "param/overlay.hpp"
#include "param/sphere_refinement.hpp"
#include "param/unfold.hpp"
#include "param/untangle.hpp"
#include "shapes.hpp"
#include "whole_map.hpp"

namespace crosspatch {
namespace {

/// A closed surface with four limbs of different lengths, over the sphere of `levels`.
TriangleMesh limbed(int levels) {
  TriangleMesh mesh = shapes::icosphere(levels);
  const Vector3d axes[] = {{0, 0, 1}, {1, 0.2, 0}, {-1, 0.4, -0.3}, {0.1, -1, -0.4}};
  const double lengths[] = {2.0, 1.5, 1.0, 0.7};
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vector3d x = mesh.position(v);
    double r = 1;
    for (int i = 0; i < 4; ++i) r += lengths[i] * std::exp(-12 * (1 - x.dot(axes[i].normalized())));
    mesh.V.row(v) = r * x.transpose();
  }
  return normalized(mesh);
}

/// The vertex farthest along `axis`.
int extreme(const TriangleMesh& mesh, const Vector3d& axis) {
  Eigen::Index best = 0;
  (mesh.V * axis.normalized()).maxCoeff(&best);
  return static_cast<int>(best);
}

std::vector<int> limb_tips(const TriangleMesh& mesh) {
  return {extreme(mesh, {0, 0, 1}),
          extreme(mesh, {1, 0.2, 0}),
          extreme(mesh, {-1, 0.4, -0.3}),
          extreme(mesh, {0.1, -1, -0.4})};
}

/// The unit sphere's vertices turned by an angle about an axis in general position.
MatrixX3d turned(const MatrixX3d& X, double angle) {
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(angle, Vector3d(0.3, 0.5, 0.8).normalized()).toRotationMatrix();
  return X * R.transpose();
}

TEST(ProgressiveMesh, EveryLevelIsAClosedSphereAndTheLastIsTheMesh) {
  const TriangleMesh mesh = limbed(3);
  const std::vector<int> tips = limb_tips(mesh);
  const auto progressive =
      make_progressive_mesh(mesh, {.shape_vertices = 200, .protected_vertices = tips});
  ASSERT_TRUE(progressive) << progressive.error().message;
  for (int n : {4, 30, 200, 400, mesh.vertex_count()}) {
    const auto level = mesh_level(mesh, *progressive, n);
    ASSERT_TRUE(level) << level.error().message;
    EXPECT_EQ(level->mesh.vertex_count(), n);
    EXPECT_EQ(euler_characteristic(level->mesh), 2);
    for (int tip : tips) {
      EXPECT_TRUE(n < 200 || std::binary_search(level->vertex.begin(), level->vertex.end(), tip));
    }
  }
  Refinement walk(*progressive);
  while (!walk.done()) walk.split();
  EXPECT_EQ(walk.compact_faces(), mesh.F);
}

TEST(SphericalEmbedding, EveryFaceIsPositiveAndTheSphereIsCoveredOnce) {
  for (const TriangleMesh& mesh :
       {limbed(3), normalized(shapes::icosphere(2)), normalized(shapes::tetrahedron())}) {
    const auto progressive = make_progressive_mesh(mesh);
    ASSERT_TRUE(progressive);
    const auto X = embed_in_sphere(mesh, *progressive);
    ASSERT_TRUE(X) << X.error().message;
    EXPECT_EQ(turned_faces(mesh.F, *X), 0);
    // Van Oosterom & Strackee: tan(angle / 2) = det / (1 + a.b + b.c + c.a) for unit vectors.
    double solid_angle = 0;
    for (int f = 0; f < mesh.face_count(); ++f) {
      const Vector3d a = X->row(mesh.F(f, 0)), b = X->row(mesh.F(f, 1)), c = X->row(mesh.F(f, 2));
      solid_angle += 2 * std::atan2(a.dot(b.cross(c)), 1 + a.dot(b) + b.dot(c) + c.dot(a));
    }
    EXPECT_NEAR(solid_angle, 4 * std::numbers::pi, 1e-9);  // rounding
  }
}

TEST(Untangling, CollapsesTurnedFacesAwayAndSplitsThemBackInOrder) {
  const TriangleMesh mesh = normalized(shapes::icosphere(3));
  MatrixX3d X = shapes::icosphere(3).V;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-0.25,
                                               0.25);  // beyond an edge: many faces turn over
  for (int v = 0; v < X.rows(); v += 5)
    X.row(v) =
        (X.row(v) + Eigen::RowVector3d(noise(random), noise(random), noise(random))).normalized();
  ASSERT_GT(turned_faces(mesh.F, X), 10);
  ProgressiveMesh full;
  full.vertex_count = mesh.vertex_count();
  full.coarsest = mesh.F;
  full.alive.assign(static_cast<std::size_t>(mesh.face_count()), true);
  Refinement level(std::move(full));
  ASSERT_TRUE(collapse_turned_faces(
      X, std::vector<bool>(static_cast<std::size_t>(mesh.vertex_count()), false), level));
  EXPECT_EQ(turned_faces(level.compact_faces(), X), 0);
  EXPECT_EQ(degree(level.compact_faces(), X), 1);
  std::vector<int> hint(static_cast<std::size_t>(mesh.vertex_count()), 0);
  ASSERT_TRUE(refine_on_sphere(
      level, mesh.V, SphereLift(), {.until_vertices = mesh.vertex_count()}, X, hint));
  EXPECT_EQ(level.compact_faces(), mesh.F);
  EXPECT_EQ(turned_faces(mesh.F, X), 0);
}

TEST(Unfolding, TurnsFacesBackAroundPinnedVertices) {
  const TriangleMesh mesh = normalized(shapes::icosphere(3));
  MatrixX3d X = shapes::icosphere(3).V;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-0.25, 0.25);
  std::vector<int> pinned;
  for (int v = 0; v < X.rows(); ++v) {
    if (v % 5 == 0)
      X.row(v) =
          (X.row(v) + Eigen::RowVector3d(noise(random), noise(random), noise(random))).normalized();
    else if (v % 7 == 0)
      pinned.push_back(v);
  }
  ASSERT_GT(turned_faces(mesh.F, X), 10);
  const MatrixX3d before = X;
  EXPECT_EQ(unfold(make_sphere_problem(mesh.F, mesh.V, pinned), X), 0);
  EXPECT_EQ(turned_faces(mesh.F, X), 0);
  EXPECT_EQ(degree(mesh.F, X), 1);
  for (int v : pinned) EXPECT_EQ(X.row(v), before.row(v));
}

TEST(Unfolding, SaysHowManyFacesStayTurned) {
  // Neighbours pinned in each other's places: no position of the others can help.
  const TriangleMesh mesh = normalized(shapes::icosphere(2));
  MatrixX3d X = shapes::icosphere(2).V;
  std::vector<int> pinned;
  for (int k = 0; k < 3; ++k) pinned.push_back(mesh.F(0, k));
  X.row(pinned[0]).swap(X.row(pinned[1]));
  EXPECT_GT(unfold(make_sphere_problem(mesh.F, mesh.V, pinned), X), 0);
}

TEST(Overlay, OfTwoTurnedSpheresIsABijection) {
  const TriangleMesh a = shapes::icosphere(3), b = shapes::icosphere(2);
  const auto map = overlay_on_sphere(a, a.V, b, turned(b.V, 0.7));
  ASSERT_TRUE(map) << map.error().message;
  const Status valid = validate(*map, a, b);
  EXPECT_TRUE(valid) << valid.error().message;
  const MapQuality quality = measure_map(*map, a, b);
  EXPECT_EQ(quality.flipped, 0);
  EXPECT_NEAR(quality.source_coverage, 1, 1e-9);  // rounding
  EXPECT_NEAR(quality.target_coverage, 1, 1e-9);
}

TEST(Overlay, OfAMeshWithItselfIsTheIdentity) {
  const TriangleMesh mesh = shapes::icosphere(2);
  const auto map = overlay_on_sphere(mesh, mesh.V, mesh, mesh.V);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->polygon_count(), mesh.face_count());
  EXPECT_EQ(map->point_count(), mesh.vertex_count());
  EXPECT_EQ(map->source_face, map->target_face);
  EXPECT_TRUE(validate(*map, mesh, mesh));
}

TEST(Overlay, KeepsCoincidingVerticesTogether) {
  const TriangleMesh a = shapes::icosphere(2), b = shapes::icosphere(3);
  MatrixX3d Y = turned(b.V, 0.4);
  // Vertex 0 of b meets vertex 5 of a: turn b on until it does, then make the doubles equal.
  const Eigen::Quaterniond q =
      Eigen::Quaterniond::FromTwoVectors(Vector3d(Y.row(0)), Vector3d(a.V.row(5)));
  Y = (Y * q.toRotationMatrix().transpose()).eval();
  Y.row(0) = a.V.row(5);
  const auto map = overlay_on_sphere(a, a.V, b, Y);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->point_of_source_vertex[5], map->point_of_target_vertex[0]);
  EXPECT_TRUE(validate(*map, a, b));
}

TEST(Overlay, NamesAVertexOnAnEdge) {
  // Vertices of the finer icosphere are midpoints of the coarser one's edges.
  const TriangleMesh a = shapes::icosphere(2), b = shapes::icosphere(1);
  SpecialPosition special;
  const auto map = overlay_on_sphere(a, a.V, b, b.V, &special);
  ASSERT_FALSE(map);
  EXPECT_TRUE(special.on_source);
  EXPECT_GE(special.vertex, b.vertex_count());
}

TEST(ChainDisc, OfASurfaceOnItselfIsAnIsometry) {
  const TriangleMesh mesh = limbed(3);
  const auto disc = cut_along_chain(mesh, limb_tips(mesh));
  ASSERT_TRUE(disc) << disc.error().message;
  EXPECT_TRUE(validate(disc->mesh));
  EXPECT_EQ(euler_characteristic(disc->mesh), 1);
  EXPECT_NEAR(disc_distortion(*disc, *disc), std::log(4.0), 1e-9);  // rounding
}

TEST(Judge, PrefersTheTruthToSwappedLimbs) {
  const TriangleMesh a = limbed(3), b = limbed(4);
  const std::vector<int> tips_a = limb_tips(a), tips_b = limb_tips(b);
  const auto source = make_shape(a, tips_a), target = make_shape(b, tips_b);
  ASSERT_TRUE(source && target);
  std::vector<int> order{0, 1, 2, 3};
  std::vector<Candidate> candidates;
  do {
    Candidate c;
    for (std::size_t i = 0; i < 4; ++i)
      c.landmarks.push_back({tips_a[i], tips_b[static_cast<std::size_t>(order[i])], false});
    candidates.push_back(c);
  } while (std::next_permutation(order.begin(), order.end()));
  const auto judgement = judge(*source, *target, candidates);
  ASSERT_TRUE(judgement) << judgement.error().message;
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(judgement->ranking[0].landmarks[i].target_vertex, tips_b[i]);
  ASSERT_GT(judgement->finals.size(), 1u);
  EXPECT_LT(judgement->ranking[0].distortion, judgement->ranking[1].distortion);

  const auto verdict = play_finals(*source, *target, *judgement, MapOptions{});
  ASSERT_TRUE(verdict) << verdict.error().message;
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(verdict->ranking[0].landmarks[i].target_vertex, tips_b[i]);
  EXPECT_GT(verdict->margin, 0.06);
  EXPECT_GE(verdict->mirrored_margin, verdict->margin);
  EXPECT_EQ(verdict->ranking.size(), candidates.size());

  // The mirrored candidate plays, however far behind it is.
  const auto two = judge(*source, *target, candidates, {.finalists = 1, .finals = 1, .leaders = 1});
  ASSERT_TRUE(two) << two.error().message;
  ASSERT_EQ(two->finals.front().candidate, 0u);
  ASSERT_GT(two->finals.size(), 1u);
  for (std::size_t i = 1; i < two->finals.size(); ++i)
    EXPECT_EQ(exchanged_pairs(two->ranking[0], two->ranking[two->finals[i].candidate]), 2);
  const auto duel = play_finals(*source, *target, *two, MapOptions{});
  ASSERT_TRUE(duel) << duel.error().message;
  EXPECT_TRUE(std::isfinite(duel->mirrored_margin));
}

TEST(Judge, CountsThePairsThatAreExchanged) {
  const auto candidate = [](const std::vector<int>& targets) {
    Candidate c;
    for (std::size_t i = 0; i < targets.size(); ++i)
      c.landmarks.push_back({static_cast<int>(i), targets[i], false});
    return c;
  };
  const Candidate identity = candidate({10, 11, 12, 13, 14});
  EXPECT_EQ(exchanged_pairs(identity, identity), 0);
  EXPECT_EQ(exchanged_pairs(identity, candidate({11, 10, 12, 13, 14})), 1);
  EXPECT_EQ(exchanged_pairs(identity, candidate({11, 10, 13, 12, 14})), 2);
  EXPECT_EQ(exchanged_pairs(identity, candidate({11, 12, 10, 13, 14})), 0);  // three in a ring
  EXPECT_EQ(exchanged_pairs(identity, candidate({11, 10, 12, 13, 15})), 0);  // another tip
  EXPECT_EQ(exchanged_pairs(identity, candidate({11, 10, 12, 13})), 0);      // fewer tips
}

TEST(MakeMap, FindsTheSameSurfaceInAnotherTriangulation) {
  const TriangleMesh a = limbed(3), b = limbed(4);
  std::vector<Landmark> landmarks;
  const std::vector<int> tips_a = limb_tips(a);
  for (int v : tips_a)
    landmarks.push_back(
        {v, v});  // the finer mesh keeps the coarser one's vertices and their numbers
  const auto source = make_shape(a, tips_a), target = make_shape(b, tips_a);
  ASSERT_TRUE(source && target);
  const auto initial = initial_maps(*source, *target, landmarks, 4);
  ASSERT_FALSE(initial.empty());
  const auto result = optimize_map(*source, *target, initial.front(), landmarks);
  ASSERT_TRUE(result) << result.error().message;
  const Status valid = validate(result->map, a, b);
  EXPECT_TRUE(valid) << valid.error().message;
  EXPECT_EQ(result->quality.flipped, 0);
  for (const Landmark& l : landmarks)
    EXPECT_EQ(result->map.point_of_source_vertex[static_cast<std::size_t>(l.source_vertex)],
              result->map.point_of_target_vertex[static_cast<std::size_t>(l.target_vertex)]);
  // The coarse mesh's faces are chords of the fine one's: errors are those of its resolution, edges
  // of about 0.05.
  double sum = 0;
  for (int v = 0; v < a.vertex_count(); ++v)
    sum += (position(b,
                     result->map.target[static_cast<std::size_t>(
                         result->map.point_of_source_vertex[static_cast<std::size_t>(v)])]) -
            b.position(v))
               .norm();
  EXPECT_LT(sum / a.vertex_count(), 0.02);
  EXPECT_LT(result->quality.median, 4.5);
}

TEST(MatchAndMap, RecoversTheSameSurfaceInOtherTriangles) {
  const TriangleMesh source = limbed(3);
  TriangleMesh target = shapes::refined(source);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(2, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  target.V = (3 * target.V * turn.transpose()).eval();
  // Where every vertex of the refined mesh lies on the other, in the root of its area.
  MatrixX3d middles(target.vertex_count(), 3);
  middles.topRows(source.vertex_count()) = source.V;
  for (int f = 0; f < source.face_count(); ++f)
    for (int k = 0; k < 3; ++k)  // the middle one of four faces: x, y, z follow a, b, c
      middles.row(target.F(4 * f + 3, k)) =
          (source.V.row(source.F(f, k)) + source.V.row(source.F(f, (k + 1) % 3))) / 2;
  const auto worst_slip = [](const TriangleMesh& onto,
                             const std::vector<SurfacePoint>& points,
                             const std::vector<int>& point_of_vertex,
                             const MatrixX3d& places) {
    double worst = 0;
    for (int v = 0; v < places.rows(); ++v)
      worst = std::max(
          worst,
          (position(
               onto,
               points[static_cast<std::size_t>(point_of_vertex[static_cast<std::size_t>(v)])]) -
           places.row(v).transpose())
              .norm());
    return worst / std::sqrt(face_areas(onto).sum());
  };
  constexpr double kRounding = 1e-5;  // what make_exact_isometry() promises
  const MatrixX3d corners = target.V.topRows(source.vertex_count());
  const auto there = match_and_map(source, target, {}, {}).value();
  expect_whole(there, source, target);
  const SurfaceMap& map = there.result.map;
  EXPECT_LT(worst_slip(target, map.target, map.point_of_source_vertex, corners), kRounding);
  EXPECT_LT(worst_slip(source, map.source, map.point_of_target_vertex, middles), kRounding);
  const auto back = match_and_map(target, source, {}, {}).value();
  expect_whole(back, target, source);
  const SurfaceMap& inverse = back.result.map;
  EXPECT_LT(worst_slip(source, inverse.target, inverse.point_of_source_vertex, middles), kRounding);
  EXPECT_LT(worst_slip(target, inverse.source, inverse.point_of_target_vertex, corners), kRounding);
}

TEST(MatchAndMap, OfASurfaceOntoItselfIsItsOwnMesh) {
  const TriangleMesh mesh = limbed(3);
  const auto matched = match_and_map(mesh, mesh, {}, {});
  ASSERT_TRUE(matched) << matched.error().message;
  const SurfaceMap& map = matched->result.map;
  EXPECT_EQ(map.polygon_count(), mesh.face_count());
  EXPECT_EQ(map.point_count(), mesh.vertex_count());
  EXPECT_EQ(map.source_face, map.target_face);
}

TEST(MakeShape, NamesATopologyItCannotMap) {
  const auto shape = make_shape(normalized(shapes::torus(2, 1, 12, 8)), {});
  ASSERT_FALSE(shape);
  EXPECT_EQ(shape.error().code, ErrorCode::kNoCorrespondence);
  EXPECT_EQ(shape.error().message,
            "surface: Euler characteristic 0 (genus 1), only spheres (2) can be mapped");
}

/// The faces of `mesh` whose corners all lie above z = height, over the vertices they use.
TriangleMesh cut_below(const TriangleMesh& mesh, double height) {
  std::vector<int> number(static_cast<std::size_t>(mesh.vertex_count()), -1);
  std::vector<int> kept;
  MatrixX3i F(mesh.face_count(), 3);
  int rows = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    if (mesh.V(mesh.F.row(f), 2).minCoeff() <= height) continue;
    for (int k = 0; k < 3; ++k) {
      int& n = number[static_cast<std::size_t>(mesh.F(f, k))];
      if (n < 0) {
        n = static_cast<int>(kept.size());
        kept.push_back(mesh.F(f, k));
      }
      F(rows, k) = n;
    }
    ++rows;
  }
  return make_mesh(mesh.V(kept, Eigen::all), F.topRows(rows)).value();
}

TEST(FillHoles, ClosesEveryLoopAndKeepsNumbers) {
  const TriangleMesh open = cut_below(limbed(3), -0.1);
  ASSERT_EQ(euler_characteristic(open), 1);
  const FilledMesh filled = fill_holes(open).value();
  EXPECT_EQ(filled.holes, 1);
  EXPECT_EQ(euler_characteristic(filled.mesh), 2);
  EXPECT_TRUE(boundary_loops(filled.mesh).empty());
  EXPECT_EQ(filled.mesh.V.topRows(open.vertex_count()), open.V);
  EXPECT_EQ(filled.mesh.F.topRows(open.face_count()), open.F);
  EXPECT_FALSE(fill_holes(limbed(2)).value().was_open());
}

TEST(MatchAndMap, MapsWhatTwoSurfacesHaveInCommon) {
  const TriangleMesh whole = limbed(4), open = cut_below(limbed(3), -0.15);
  const auto matched = match_and_map(whole, open, {}, {});
  ASSERT_TRUE(matched) << matched.error().message;
  EXPECT_EQ(matched->holes, (std::array<int, 2>{0, 1}));
  const SurfaceMap& map = matched->result.map;
  const Status partial = validate_partial(map, whole, open);
  EXPECT_TRUE(partial) << partial.error().message;
  EXPECT_FALSE(validate(map, whole, open));  // it does not cover the whole source
  EXPECT_NEAR(matched->result.quality.target_coverage, 1, 1e-9);
  EXPECT_LT(matched->result.quality.source_coverage, 0.99);
  EXPECT_EQ(matched->result.quality.flipped, 0);
  int unmapped = 0;
  double error = 0;
  for (int v = 0; v < whole.vertex_count(); ++v) {
    const int q = map.point_of_source_vertex[static_cast<std::size_t>(v)];
    unmapped += q < 0 ? 1 : 0;
    if (q >= 0)
      error += (position(open, map.target[static_cast<std::size_t>(q)]) - whole.position(v)).norm();
  }
  EXPECT_GT(unmapped, 0);
  EXPECT_LT(error / (whole.vertex_count() - unmapped), 0.05);  // an edge of the coarser mesh
}

TEST(MatchAndMap, TakesTheRimOfAHoleToThatOfTheOther) {
  const TriangleMesh source = cut_below(limbed(4), -0.15), target = cut_below(limbed(3), -0.15);
  const auto matched = match_and_map(source, target, {}, {});
  ASSERT_TRUE(matched) << matched.error().message;
  EXPECT_FALSE(matched->is_partial());
  EXPECT_TRUE(matched->valid) << matched->valid.error().message;
  expect_whole(*matched, source, target);
}

TEST(MatchAndMap, KeepsLandmarksNearRims) {
  const TriangleMesh source = cut_below(limbed(4), -0.15), target = cut_below(limbed(3), -0.15);
  const Landmark on_rims{boundary_loops(source)[0][0], boundary_loops(target)[0][0]};
  const auto matched = match_and_map(source, target, {on_rims}, {});
  ASSERT_TRUE(matched) << matched.error().message;
  EXPECT_TRUE(matched->valid) << matched->valid.error().message;
  const SurfaceMap& map = matched->result.map;
  const int q = map.point_of_source_vertex[static_cast<std::size_t>(on_rims.source_vertex)];
  ASSERT_GE(q, 0);
  EXPECT_EQ(position(target, map.target[static_cast<std::size_t>(q)]),
            target.position(on_rims.target_vertex));
}

/// A torus with a bump, so that no turn of it looks like another one.
TriangleMesh bumpy_torus(int rings, int sides) {
  TriangleMesh mesh = shapes::torus(2, 0.7, rings, sides);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vector3d p = mesh.position(v), middle = 2 * Vector3d(p.x(), p.y(), 0).normalized();
    const double near = (p - Vector3d(2, 0.5, 0.7)).squaredNorm();
    mesh.V.row(v) += (p - middle).transpose() * std::exp(-near / 0.3);
  }
  return mesh;
}

TEST(MatchAndMap, GoesOnAcrossCutHandles) {
  const TriangleMesh source = bumpy_torus(40, 20), target = bumpy_torus(33, 24);
  const auto matched = match_and_map(source, target, {}, {});
  ASSERT_TRUE(matched) << matched.error().message;
  EXPECT_EQ(matched->handles, (std::array<int, 2>{0, 0}));
  EXPECT_TRUE(matched->valid) << matched->valid.error().message;
  expect_whole(*matched, source, target);
}

TEST(MatchAndMap, GoesOnAcrossTheCutsOfEveryHandle) {
  const TriangleMesh mesh = shapes::double_torus();
  const auto matched = match_and_map(mesh, mesh, {}, {});
  ASSERT_TRUE(matched) << matched.error().message;
  EXPECT_FALSE(matched->is_partial());
  EXPECT_TRUE(matched->valid) << matched->valid.error().message;
  expect_whole(*matched, mesh, mesh);
}

TEST(MatchAndMap, CutsHandlesThatTheOtherSurfaceDoesNotHave) {
  const TriangleMesh torus = bumpy_torus(20, 10), ball = shapes::icosphere(2);
  const auto matched = match_and_map(torus, ball, {}, {});
  ASSERT_TRUE(matched) << matched.error().message;
  EXPECT_EQ(matched->handles, (std::array<int, 2>{1, 0}));
  EXPECT_TRUE(matched->valid) << matched->valid.error().message;
  EXPECT_FALSE(validate(matched->result.map, torus, ball));
}

}  // namespace
}  // namespace crosspatch
