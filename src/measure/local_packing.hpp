#pragma once
/// The packing fraction about a place, measured in the ways of the lectures on Voronoi analysis.
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/kernel.hpp"
#include "measure/cell_grid.hpp"
#include "measure/voronoi_cells.hpp"

namespace grainvdb {

/// Volume that two balls have in common, the distance of their centres and their radii given [length³].
double common_volume(double distance, double r1, double r2);

/// Grains, what they take of the room, and a search among them.
class LocalPacking {
 public:
  /// `reach` is the radius of windows and local averages, > 0 [length].
  LocalPacking(const Box& box, const Columns3& position, const std::vector<double>& radius, const VoronoiCells& cells,
               double reach);

  /// Whether grain i has a cell that ends at other grains alone.
  bool is_enclosed(std::size_t i) const { return cells_.volume[i] > 0 && !cells_.at_face[i]; }
  /// Volume of a grain over that of its cell.
  double of_cell(std::size_t i) const { return volume_[i] / cells_.volume[i]; }
  /// ΣV/ΣV_cell over the enclosed grains within reach of grain i, itself included.
  double about(std::size_t i) const;

  /// A spherical window about x, by three measures.
  struct Window {
    bool enclosed = false;  ///< whether it holds a centre, and none of those that are not enclosed
    double by_centres = 0;  ///< Σ V of the grains whose centre lies inside, over the volume of the window
    double by_volume = 0;   ///< the volume of grains inside, exactly for spheres that do not overlap, over the same
    double by_cells = 0;    ///< ΣV/ΣV_cell of the grains whose centre lies inside
  };
  Window window(const Vec3& x) const;

 private:
  const VoronoiCells& cells_;
  const std::vector<double>& radius_;
  std::vector<double> volume_;
  double reach_;
  CellGrid grid_;
};

/// The field φ (6) at the centres of grains: Σ_j V_j W(x_i - x_j), grain i included.
std::vector<double> kernel_packing(const Box& box, const Columns3& position, const std::vector<double>& radius,
                                   const LucyKernel& kernel);

}  // namespace grainvdb
