#pragma once
/// How much of a ball lies within a box: the exact normalisation of pair counts near faces.
#include <array>

namespace grainvdb {

/// Distances ≥ 0 from a point inside a box to its six faces, lower and upper of each axis; infinity where there is
/// none.
using FaceDistances = std::array<std::array<double, 2>, 3>;

/// Volume of the ball of radius r about the point that lies inside the box, in closed form.
///
/// With the six caps beyond the faces, the twelve double caps beyond two of them and the eight triple caps beyond
/// three,
///
///     V = 4/3 π r³ - Σ V₁(a) + Σ V₂(a,b) - Σ V₃(a,b,c),
///
/// each by the divergence theorem from its part A of the sphere, which is r² times 2π less turning angles (Gauss and
/// Bonnet), and from its flat faces: V₃ = (r A₃ - a F(a;b,c) - b F(b;c,a) - c F(c;a,b))/3.
double ball_in_box(double r, const FaceDistances& faces);

}  // namespace grainvdb
