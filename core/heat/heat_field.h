/// core/heat/heat_field.h: temperature of bone in a grid of cells: conduction, sources, chips, cooling, thermal dose.
///   A cell has a share f of bone, 0..1, of which it had w at most: the material has the capacity rho c w and the conductivity k w, and fills
///   the part g = f / w of the cell, the rest was cut away. Between two cells heat passes through the face of the fuller one, m = max(g1, g2),
///   over the part g / m of half a cell on either side: conductance k (A / d) 2 m^2 / (g1 / w1 + g2 / w2). In bone that is not cut this is the
///   harmonic mean of w1 and w2. A cell with f < kLeastShare holds no heat. A free surface is insulated unless it is cooled. Beyond the domain,
///   bone is at body temperature.
///   Cutting  its heat enters evenly over the steps of conduction. It enters with the sweeps along the axes, in proportion to the squares of
///           the components of the cut surface. If its cell is empty by then, it enters the three cells behind that, or is unplaced. The
///           temperature of a cell is the mean of its bone. Bone leaves at that of the cut surface: with the power P through a cut of the
///           area S, of which Q goes on to the cells beside, a parabola is warmer there by (2 P + Q) / 3 x g V / (2 k w S^2). Share and
///           temperature are the means of a step there, and conductances between cells those of its middle.
///   Integration  along one axis after the other (locally one-dimensional), the order reversed from step to step, that with most of the heat in
///           the middle. Along an axis of the
///           number lambda = k dt / (rho c h^2), a share s of the step is implicit: s = 1/2 - 1 / (12 lambda), at least 0, for lambda up to
///           1/3, which is of fourth order in h in even bone (Crandall 1955, Douglas 1956); s = 1, backward Euler, above. Between cells of cut
///           bone the explicit part of the conductance is at most half of the smaller share. Each sweep keeps the energy, and makes no new
///           extremum, at any length of the step.
///   Frame   cells, i fastest.   Units  SI; temperatures as the rise above the body's [K]; dose [min] of thermal_dose.h.
///   Errors  out_of_range from create().   Thread  one.
///   Source  own derivation from the heat equation; values of bone: [facts] heat.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

struct HeatConfig {
  double conductivity = 0.5;  ///< [W/(m K)] > 0; cortical bone 0.31 to 0.80
  double density = 1810.0;    ///< [kg/m^3] > 0, cortical bone
  double capacity = 1250.0;   ///< [J/(kg K)] > 0, cortical bone
  double body = 37.0;         ///< [C]
  double fourier =
      0.2236;  ///< [-] > 0: lambda of a step, h the shortest edge of a cell; 1 / sqrt(20): of sixth order; above 1/3: backward Euler
  double least_rise = 0.01;  ///< [K] > 0: cells with a smaller rise are outside the box in which heat is conducted
  /// @returns k / (rho c) [m^2/s].
  [[nodiscard]] double diffusivity() const noexcept { return conductivity / (density * capacity); }
};

/// Where heat came from and went to; input = in bone + chips + cooled + edge + unplaced.
struct HeatBalance {
  double input = 0.0;     ///< [J] released by cutting
  double chips = 0.0;     ///< [J] left with removed bone
  double cooled = 0.0;    ///< [J] taken by the coolant
  double edge = 0.0;      ///< [J] left through the edge of the domain
  double unplaced = 0.0;  ///< [J] released where no bone was left to take it, or outside the domain
};

/// A coolant that wets the free surface of bone in a ball, above its centre: it lies round the bit, and not on the far side of bone.
struct Cooling {
  Vec3 centre{0.0};        ///< [cells] centre of the ball
  Vec3 up{0.0, 0.0, 1.0};  ///< [-] unit, axes of the cells: cells that lie more than a cell below the centre stay dry
  double radius = 0.0;     ///< [m]
  double film = 0.0;       ///< [W/(m^2 K)] heat transfer coefficient
  double rise = 0.0;       ///< [K] temperature of the coolant above the body's; usually below 0
  /// [W/K] flow of heat capacity that arrives: it takes no more heat than warms it to the hottest bone that it wets.
  double arriving = 0.0;
};

class HeatField {
 public:
  static constexpr float kLeastShare = 0.02f;  ///< [-] cells with less bone hold no heat

  /// @param edges [m] of a cell. @param domain in cells; without bone at first, all at body temperature.
  [[nodiscard]] static Result<HeatField> create(const HeatConfig& config, const Vec3& edges, const VoxelBox& domain);
  /// @returns the memory [bytes] of a domain of that many cells.
  [[nodiscard]] static std::uint64_t bytes_of(std::uint64_t cells) noexcept { return cells * (7 * sizeof(float) + sizeof(std::uint32_t)); }

  /// Sets the share of bone in a box of cells, i fastest; parts outside the domain are ignored. Bone that vanishes takes its heat with it
  /// (chips), and the loss is remembered for release(). Bone that appears is at body temperature.
  void set_bone(const VoxelBox& box, std::span<const float> share);
  /// Releases heat [J] at the bone that was removed since the last call: each cell's part in proportion to its loss, to the cell, or, if
  /// it is empty, to the bone behind it. The heat enters with the steps of the next advance().
  void release(double joule);
  /// Forgets losses that are no cutting, as after an undo.
  void forget_losses() noexcept { losses_.clear(); }
  /// Releases heat [J] in a cell.
  void release_at(const Vec3i& cell, double joule);
  /// Cools the free surface for `dt` [s].
  void cool(const Cooling& cooling, double dt);

  /// Conducts for `dt` [s] in steps of longest_step(), and cools after each. A rest that is shorter waits for the next call.
  /// @param cooling null: none.
  void advance(double dt, const Cooling* cooling = nullptr);
  /// One step of any length [s] > 0. For tests of the integration, and for advance().
  void step(double dt);
  [[nodiscard]] double longest_step() const noexcept { return longest_; }  ///< [s]

  [[nodiscard]] const VoxelBox& domain() const noexcept { return domain_; }
  [[nodiscard]] const VoxelBox& warm() const noexcept { return warm_; }  ///< holds every cell with a rise of at least least_rise
  [[nodiscard]] const Vec3& edges() const noexcept { return edges_; }
  [[nodiscard]] float rise(const Vec3i& cell) const noexcept { return at(rise_, cell); }    ///< [K]; 0 outside
  [[nodiscard]] float share(const Vec3i& cell) const noexcept { return at(share_, cell); }  ///< [-]; 0 outside
  /// @returns the part of a cell that bone fills: 1 unless some was cut away [-]; 0 outside.
  [[nodiscard]] double filled(const Vec3i& cell) const noexcept { return domain_.contains(cell) ? filled(domain_.offset_of(cell)) : 0.0; }
  /// @returns the same of a cell beside one, or that of the one if the other never held bone: nothing was cut there.
  [[nodiscard]] double filled_beside(const Vec3i& cell, const Vec3i& other) const noexcept {
    return domain_.contains(other) && inverse_whole_[domain_.offset_of(other)] > 0.0f ? filled(other) : filled(cell);
  }
  [[nodiscard]] float peak(const Vec3i& cell) const noexcept { return at(peak_, cell); }  ///< [K] largest rise so far
  [[nodiscard]] float dose(const Vec3i& cell) const noexcept { return at(dose_, cell); }  ///< [min]
  [[nodiscard]] double hottest() const noexcept { return hottest_; }                      ///< [K] largest rise after the last step
  [[nodiscard]] const HeatBalance& balance() const noexcept { return balance_; }
  [[nodiscard]] double in_bone()
      const noexcept;  ///< [J] above body temperature, and what was released and waits for a step; visits all cells
  [[nodiscard]] double highest_peak() const noexcept;  ///< [K] of the bone that is left; visits all cells
  [[nodiscard]] std::uint64_t steps() const noexcept { return steps_; }
  [[nodiscard]] std::uint64_t conducted_cells() const noexcept { return conducted_; }  ///< sum over the steps

 private:
  HeatField(const HeatConfig& config, const Vec3& edges, const VoxelBox& domain);
  [[nodiscard]] float at(const std::vector<float>& field, const Vec3i& cell) const noexcept {
    return domain_.contains(cell) ? field[domain_.offset_of(cell)] : 0.0f;
  }
  /// The bone behind a cell that was cut away.
  struct Behind {
    std::array<Vec3i, 3> cells;  // next to it along each axis
    // [-] of its heat for each: by the square of the normal's component, and by the bone that each holds. All 0: none holds bone.
    Vec3 part{0.0};
  };
  void add(std::size_t at, const Vec3i& cell, double joule);
  /// Puts a part of the heat that waits into bone, and takes from each cell what its bone carried away above its mean temperature.
  void settle(double part);
  [[nodiscard]] Behind behind(const Vec3i& cell) const noexcept;
  void place_behind(const Vec3i& cell, const Behind& behind, double joule);
  /// Heat for the next step. @param along [-] the part that enters with the sweep along each axis.
  void put(const Vec3i& cell, double joule, const Vec3& along);
  void remember(std::size_t at, double share);
  void conduct(double dt);
  void catch_up();
  [[nodiscard]] double filled(std::size_t at) const noexcept {
    return static_cast<double>(share_[at]) * static_cast<double>(inverse_whole_[at]);
  }
  /// @returns how much less of a face bone fills on one side of a cell than on the other, for each axis, times the area of the face [m^2].
  [[nodiscard]] Vec3 cut_surface(const Vec3i& cell) const noexcept;
  /// @returns how much warmer the cut surface of a full cell is than the mean of its bone [K/W].
  [[nodiscard]] double half_resistance(const Vec3i& cell) const noexcept;
  /// @returns the flow of heat from a cell to those beside it [W].
  [[nodiscard]] double outflow(const Vec3i& cell) const noexcept;
  void sweep(int axis, const VoxelBox& box, double lambda);
  /// @returns the implicit share of a step along an axis [-].
  [[nodiscard]] static double implicit_share(double lambda) noexcept;
  /// @returns the flow through an outer face of a row of lines [K], for lambda = 1.
  [[nodiscard]] double edge_flow(std::size_t row, std::size_t lines, std::size_t beside) const noexcept;
  void finish(const VoxelBox& box, double dt);
  [[nodiscard]] double free_area(const Vec3i& cell) const noexcept;

  struct Loss {
    Vec3i cell;
    float share;  // [-] of bone that was removed
  };
  struct Heating {
    Vec3i cell;
    double share;  // [-] of bone that was removed, its heat above the mean not taken yet
    double joule;  // [J] that waits for a step
  };
  struct Removal {
    std::size_t at;  // the cell, or one behind it if it is empty now
    float share;     // [-] of bone that was removed before a step
    float rise;      // [K] of that cell then
  };
  struct Source {
    std::size_t at;
    float amount;  // [K] in a cell full of bone
    Vec3 along;    // [-] part for the sweep along each axis
  };
  HeatConfig config_;
  Vec3 edges_;
  VoxelBox domain_, warm_;
  double unit_;           // [J/K] capacity of a cell full of bone
  double longest_;        // [s]
  double waiting_ = 0.0;  // [s] not conducted yet
  double heating_ = 0.0;  // [s] in which what waits was released
  double hottest_ = 0.0;
  int middle_ = 1;  // axis of the second sweep
  std::vector<float> rise_, share_, peak_, dose_;
  std::vector<float> inverse_whole_;                                 // [-] one over the largest share so far
  std::vector<std::uint32_t> slot_;                                  // one more than the place in heatings_; 0: none
  std::vector<float> slope_, partial_, rest_, implicit_, explicit_;  // scratch of a sweep
  std::vector<float> source_;                                        // [K] that enters with a sweep; 0 between
  std::vector<float> cut_;                                           // [-] half of what was removed before a step; 0 after it
  std::vector<Loss> losses_;                                         // since release()
  std::vector<Heating> heatings_;                                    // since a step
  std::vector<Removal> removals_;                                    // of the step
  std::vector<Source> sources_;                                      // of the step
  HeatBalance balance_;
  std::uint64_t steps_ = 0, conducted_ = 0;
};

}  // namespace burrhole
