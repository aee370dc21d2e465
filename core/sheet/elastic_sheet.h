/// core/sheet/elastic_sheet.h: a thin elastic sheet that is clamped at its rim, rests on a soft body, may stick to bone, and is pushed by a
///   tool: the dura under a burrhole.
///   Frame  of the sheet: x, y along it, +z towards the bone.   Units  SI.   Errors  out_of_range from create().   Thread  one.
///   Energy  U = sum over edges of k (l - l0)^2 / 2, k = sqrt(3)/2 E t: the triangular lattice with the plane stiffness E t and the Poisson's
///           ratio 1/3; + sum over nodes of D A |2 / (3 s^2) sum over neighbours (u_j - u_i)|^2 / 2, D = E t^3 / (12 (1 - 1/9)): bending; + A g u_z^2 / 2:
///           the body below; + A a |u|^2 / 2 where the sheet sticks to bone; + A c max(0, u_z)^2 / 2 where it lies under bone;
///           + c_p max(0, z_sheet - z)^2 / 2 for each point of the tool below the sheet's rest; - p A u_z: pressure from below. u is the
///           displacement from the shape at rest, A and s area and spacing of the lattice.
///   Step    x minimises U(x) + sum of A b |x - x_before|^2 / (2 dt), b the resistance of what is moved aside; inertia is left out: the sheet weighs
///           half a gram. Each iteration lowers that sum, so with constant loads U never grows, at any dt and however few iterations are made. These
///           are the compliant constraints of [Macklin16] (XPBD) without inertia, solved together by Newton's method and conjugate gradients
///           in place of sweeps: a sweep per step adds 2 dt^2 / m to the compliance of each constraint, which for this stiff sheet would be
///           all of it.
///   Tear    an edge that is longer than (1 + strain_limit) l0 breaks; the tool passes triangles with a broken edge and those cut out. A step in which an edge would
///           be longer by more than 2 % of the limit is divided (sheet_step.cpp): it is shortened until the longest edge just reaches the limit; that
///           edge breaks, the part is solved again without it, and the rest of the step follows. So what tears does not depend on the step.
///           The sheet comes off the bone where a |u| exceeds `adhesion`, for good.
///   Source  stiffness of the lattice: Seung & Nelson 1988; the rest is our own derivation.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"
#include "core/sheet/sheet_lattice.h"
#include "core/sheet/sheet_solver.h"

namespace burrhole {

struct SheetConfig {
  double modulus = 70e6;        ///< [Pa] > 0: E of dura; 70 +- 44 MPa in print
  double thickness = 0.5e-3;    ///< [m] > 0: t of dura; 0.3 to 0.8 mm
  double strain_limit = 0.11;   ///< [-] > 0: 11 +- 3 % in print
  double support = 2e5;         ///< [N/m^3] >= 0: g; brain of about 2 kPa over 10 mm (an assumption)
  double resistance = 2e4;      ///< [N s/m^3] > 0: b (an assumption)
  double adhesion = 5e3;        ///< [Pa] >= 0: strength of the bond to bone (an assumption)
  double adhesion_way = 1e-4;   ///< [m] > 0: displacement at which it breaks; a = adhesion / adhesion_way (an assumption)
  double bone_stiffness = 1e9;  ///< [N/m^3] >= 0: c
  double tool_stiffness = 2e4;  ///< [N/m] > 0: c_p of a point of the tool
  double tension = 0.0;         ///< [-] >= 0: strain of the sheet at rest, by which the edges are longer than l0
};

/// Over the sheet, bone or not.
enum class SheetCover : std::uint8_t { open, bone };

struct SheetLoad {
  double pressure = 0.0;                ///< [Pa] towards +z
  std::span<const Vec3> tool_points{};  ///< [m] sheet frame, at the end of the step
  std::span<const Vec3> tool_from{};    ///< [m] the same points at its start; another number of them: they stood where they end
};

/// State of a sheet after a step.
struct SheetState {
  double force = 0.0;        ///< [N] on the tool, towards +z
  double stiffness = 0.0;    ///< [N/m] change of the force for a tool that moves on towards -z, the sheet at equilibrium
  double indentation = 0.0;  ///< [m] largest displacement of a node towards -z
  double bulge = 0.0;        ///< [m] largest displacement of a node towards +z
  double strain = 0.0;       ///< [-] largest of an edge that is whole
  double peak = 0.0;         ///< [N] largest force within the step
  double deepest = 0.0;      ///< [m] largest indentation within the step, with a force
  double stretched = 0.0;    ///< [-] largest strain within the step, before an edge broke
  double energy = 0.0;       ///< [J] U without the load of pressure
  double separated = 0.0;    ///< [m^2] that came off the bone
  std::size_t torn = 0;      ///< edges that broke so far
  std::size_t parts = 0;     ///< solutions of the step: 1 unless an edge came near its limit
};

class ElasticSheet {
 public:
  /// @param height [m] z of each node at rest. out_of_range: a value of the config outside the range of its comment, or heights of another
  /// number than nodes.
  [[nodiscard]] static Result<ElasticSheet> create(const SheetConfig& config, SheetLattice lattice, std::span<const double> height);

  /// Reserves memory, so that steps with up to this number of points of the tool do not allocate.
  void reserve(std::size_t points) { pressed_.reserve(points); }
  /// Sets whether bone lies over a node. Where bone goes, the sheet is free; where it comes back, it does not stick again.
  void cover(std::size_t node, SheetCover cover) noexcept;
  /// @param dt [s] > 0. At most kMostParts + kMostLastParts solutions.
  const SheetState& step(double dt, const SheetLoad& load);
  static constexpr std::size_t kMostParts = 160, kMostLastParts = 20;

  [[nodiscard]] const SheetState& state() const noexcept { return state_; }
  [[nodiscard]] const SheetLattice& lattice() const noexcept { return lattice_; }
  [[nodiscard]] const Vec3& position(std::size_t node) const noexcept { return x_[node]; }
  [[nodiscard]] const Vec3& rest(std::size_t node) const noexcept { return rest_[node]; }
  [[nodiscard]] bool is_broken(std::size_t edge) const noexcept { return broken_[edge] != 0; }
  [[nodiscard]] std::size_t bytes() const noexcept;
  [[nodiscard]] std::uint64_t iterations() const noexcept { return iterations_; }  ///< of Newton's method, of all steps

 private:
  ElasticSheet(const SheetConfig& config, SheetLattice lattice);
  struct Pressed {  // a point of the tool over the sheet
    SheetLattice::Place place;
    std::array<std::uint32_t, 3> edges;  // opposite to the nodes
    double z;
  };
  using Field = std::vector<Vec3>;
  /// Points of the tool over whole triangles, at a share of the step.
  void find_pressed(const SheetLoad& load, double share);
  /// Minimises the merit from x_, where it is `now`. @returns whether the forces that are left are small enough.
  bool minimise(double per_dt, double pressure, double now);
  /// What an edge may be strained to in a solution.
  enum class Edges : std::uint8_t { below_limit, any };
  struct Part {
    double share, length;  // [-] of the step, at its start; of it
    Edges edges;
  };
  /// Solves a part of the step and breaks edges until none is above the limit, or the bound on solutions is reached. @returns false, with the sheet as before: an edge is too long.
  bool advance(const Part& part, double dt, const SheetLoad& load);
  [[nodiscard]] double height_at(const SheetLattice::Place& place, const Field& x) const noexcept;
  [[nodiscard]] double energy(const Field& x) noexcept;
  [[nodiscard]] double merit(const Field& x, double per_dt, double pressure) noexcept;
  double slope(const Field& x, double per_dt, double pressure, Field& out) noexcept;
  void curve(const Field& x, double per_dt);  // second derivatives at x
  void invert_diagonal() noexcept;
  /// @param out where to start; receives the solution.
  void solve(const Field& right, Field& out, double tolerance);
  /// @returns the k-th neighbour; beyond the rim, which is clamped, that of the mirrored sheet, or none.
  [[nodiscard]] std::uint32_t beside(std::size_t node, std::size_t k) const noexcept;
  void assemble_bending();
  /// @returns the force [N] of bending at a free node, for displacements that are 0 on the rim.
  [[nodiscard]] Vec3 bending_at(const Field& u, std::size_t node) const noexcept;
  void hold_rim(Field& out) const noexcept;
  /// Starts from where the motion of the last solution leads, if the merit is lower there. @returns the merit of the start.
  double predict(double dt, double pressure);
  [[nodiscard]] double strain_of(std::size_t edge) const noexcept;
  [[nodiscard]] double largest_strain() const noexcept;
  [[nodiscard]] double tool_force() const noexcept;
  [[nodiscard]] double lowest() const noexcept;
  /// Breaks edges above the limit and above a strain. @returns how many.
  std::size_t break_edges(double above) noexcept;
  /// Finds the nodes that whole edges still join to the rim: what is cut out is not pressed.
  void find_held() noexcept;
  void come_off() noexcept;
  void measure();

  SheetConfig config_;
  SheetLattice lattice_;
  double edge_stiffness_, bending_;    // [N/m]; [N/m] of the sum of differences
  Field rest_, x_, before_, moved_;    // moved_: by the last solution
  double moved_in_ = 0.0;              // [s] of moved_; 0: none yet
  std::vector<std::uint32_t> rim_;     // nodes
  std::optional<SheetSolver> solver_;  // with the second derivative of bending on the free nodes, which is constant
  std::vector<double> length_;         // [m] l0
  std::vector<std::uint8_t> broken_;   // edges
  std::vector<std::uint8_t> sticks_, under_bone_;
  std::vector<std::uint8_t> held_;    // nodes, joined to the rim by whole edges
  std::vector<std::uint32_t> queue_;  // nodes, of the search for them
  std::vector<Pressed> pressed_;
  // Second derivatives: of edges, with the points of the tool between their nodes, and what is diagonal at nodes.
  std::vector<SheetBlock> edge_curve_;
  std::vector<double> all_, up_;  // [N/m] of a node: in all directions; along z
  Field gradient_, direction_, trial_, residual_, shift_;
  Field give_;                        // [-] displacement per way of the tool, of the last step with a force
  std::vector<SheetBlock> diagonal_;  // inverse blocks
  SheetState state_;
  std::uint64_t iterations_ = 0;
};

}  // namespace burrhole
