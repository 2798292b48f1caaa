#pragma once

#include "param/sphere_optimizer.hpp"

namespace crosspatch {

/// Moves the free rows of `X` (#V x 3, unit vectors) until no face of the problem is turned over on
/// the sphere; keeps the degree of the map. Faces strive for the shapes and the orientations the
/// problem holds for them. Returns the number of faces still turned when no step helps any more.
///
/// Source: Garanzha, Kaporin, Kudryavtseva, Protais, Ray & Sokolov 2021, "Foldover-free maps in 50
/// lines of code", Eqs. (2)-(4) with their rule for epsilon; here by Gauss-Newton steps.
int unfold(const SphereProblem& problem, MatrixX3d& X);

/// Lowers the same energy without epsilon, a barrier, over all free rows of an embedding: evens out
/// squeezed parts. Precondition: no face is turned over.
void smooth_on_sphere(const SphereProblem& problem, MatrixX3d& X);

}  // namespace crosspatch
