/// core/drill/cut_face.h: recession of the face of bone under a spinning tool, at sub-voxel resolution.
///   Frame  index coordinates of the bone; nodes are voxel centres.   Units  as each member states.   Errors  none.   Thread  simulation.
///   Source own derivation.
///   Symbols; lengths are in voxel edges:
///     e, s   erosion factor [1/rev], spin [rev/s]
///     h, dt  max(hardness, 0.1) [-], duration of a sub-step [s]
///     a      share of the overlap that a sub-step removes, 1 - exp(-e s dt / h) for law `rate`
///     phi    signed distance of a node to the face, positive outside bone
///     D(p)   signed distance of a place p to the tool, negative inside; D without an argument: at the node
///     w      overlap of face and tool at the node, w = -D - phi > 0
///     u      unit vector, direction of the force of bone on the tool
///     l      lag of the face behind the tool along u: -D(p - l u) = phi, with p the place of the node
///   Law  Bone of mass M inside the tool decays: dM/dt = -(e s / h) M. The loss is taken off the face through which the tool entered. Bone
///   therefore stays solid up to a sharp face, which recedes along its normal at the speed (e s / h) w. With a pressure on the cutting face
///   proportional to w, this is Preston's law of abrasive wear. A flat face that is fed at the speed v lags the tool by v h / (e s).
///   If instead the density of every voxel inside the tool decayed, the same mass would be removed, but the 0.5 level would pass a voxel
///   ln 2 h / (e s) [s] after the tool entered it. With this delay any step of the feed would repeat without end.
///   Start  phi of a node outside bone, or of one whose nearest surface faces the tool, starts as the distance to the surface of the bone.
///   Other nodes, and those deeper in bone than the band of known distances, have no phi until the tool is kFollow from them. Then it is
///   computed from the lag of the neighbour in the direction u; close to the tool, from any neighbour that has a phi.
///   Step  max(phi, -D) is the distance to bone if all bone inside the tool were removed. A sub-step sets phi to the larger of
///     phi + a w            the face recedes along the normal of the tool
///     -D(p - (1 - a) l u)  the face, a copy of the tool's surface moved by l along u, follows the tool by the share a of its lag
///   On smooth faces the two agree. At the rim of a flat end -D is at most the distance to the side of the tool, and the first alone would
///   leave a fillet as high as the overlap.
///   Density  Occupancy x remaining is lowered to 1/2 - phi / (2 kRamp), clamped to 0..1. Its 0.5 level lies at phi = 0 and reproduces a
///   plane within 0.02 voxel edge. Where the surface as loaded is steeper or wider than this ramp, face_removal.cpp scales or widens it.
///   The ramp and a sharp face differ in mass by kRamp^2 / 6 (1/R1 + 1/R2) per area, R1 and R2 the principal radii of curvature of the
///   face.
///   Tool placed inside bone  It overlaps no face. The density of the voxels inside it decays by the law. As soon as one of them is below
///   0.5, the face is set to the surface of the tool.
///   When bone grows back (restore, undo), phi starts anew from the bone. In a voxel that was whole as loaded and has been cut, it starts at the
///   distance that has its density on the ramp of that cut, so that its density follows from there as in one run.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/drill/erosion.h"
#include "core/drill/face_kernels.h"
#include "core/tool/cutting_field.h"
#include "core/tool/field_kernels.h"
#include "core/tool/field_sampler.h"
#include "core/voxel/surface_records.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// A voxel with bone inside a tool that overlaps no face.
struct Buried {
  std::uint32_t at;  ///< offset into the window
  float tool;        ///< [voxel edges] D, below 0
  float wear;        ///< [1/rev] e / h
  float radius;      ///< [m] from the tool's axis
};

/// Places in the cutting field, in units of its nodes, as arrays that are padded for the kernels.
struct FieldPlaces {
  std::vector<float> x, y, z;  ///< [nodes]
  std::size_t count = 0;
  void resize(std::size_t to) {
    count = to;
    if (x.size() >= count + kFieldPad) return;
    for (std::vector<float>* list : {&x, &y, &z}) list->resize(2 * count + kFieldPad);
  }
};

/// Moves the face of bone. One sub-step: find(), then recede() as often as needed, then keep().
class CutFace {
 public:
  static constexpr float kRamp = 0.75f;                              ///< [voxel edges] half width of the ramp of density across a face
  static constexpr float kFollow = static_cast<float>(kRecordBand);  ///< [voxel edges] from the tool, up to which faces are followed
  static constexpr float kFree = 2.0f;                               ///< [voxel edges] a node further out than this no longer changes
  static constexpr float kLeastHardness = 0.1f;                      ///< [-] of h

  /// @pre `field` is not null.
  explicit CutFace(std::shared_ptr<const CuttingField> field);

  /// Finds the voxels whose face overlaps the tool, ordered by block. @param reaction u, tool frame.
  /// @returns the number of voxels inside the tool but outside the erodible box.
  std::uint32_t find(Voxmap& voxmap, const Affine& index_from_tool, const Vec3& reaction);
  /// The voxels of the last find().
  [[nodiscard]] const FaceNodes& nodes() const noexcept { return nodes_; }
  [[nodiscard]] double radius(std::size_t node) const noexcept;  ///< [m] from the tool's axis
  /// Voxels with bone inside the tool of the last find(), for a tool that was placed inside bone; empty unless there are no nodes. Their
  /// density decays by the law.
  [[nodiscard]] std::span<const Buried> buried() const noexcept { return buried_; }
  /// For a tool that was placed inside bone: sets phi of the nodes that have none to -D, with the tool of the last find(), so that the face
  /// lies at its surface. To be called when the density of a voxel of buried() has fallen below 0.5.
  void open() noexcept;
  /// For tests: the next find() visits every block, also those that the tool cannot have reached since the last visit.
  void visit_all() noexcept { quiet_.clear(); }
  /// Computes phi after a sub-step of `turns` [rev]; the nodes keep theirs. @returns phi [voxel edges] of each node, in their order.
  std::span<const float> recede(double turns);
  /// Writes the result of the last recede() into the nodes, and computes the normals of faces that have moved.
  void keep();
  /// @returns the density [-] of a voxel at the distance `phi` from the face. @param ramp [voxel edges] half width of the ramp.
  [[nodiscard]] static float density_of(float phi, float ramp = kRamp) noexcept {
    return std::clamp(0.5f - phi / (2.0f * ramp), 0.0f, 1.0f);
  }

  /// @returns the number of nodes for which lists are reserved: every voxel within kFollow of the cutting surface, and the ramp.
  /// @param edge [m] of a voxel.
  [[nodiscard]] static std::size_t reserved_nodes(const CuttingField& field, double edge) noexcept;
  /// @returns the memory of the lists for that number of nodes.
  [[nodiscard]] static std::size_t list_bytes(std::size_t nodes) noexcept;
  /// @returns the memory of what is known of a block from earlier visits.
  [[nodiscard]] static constexpr std::size_t quiet_bytes() noexcept { return sizeof(QuietParts); }

 private:
  struct Sweep;
  /// A part of a block without a voxel whose face overlaps the tool, and without one that must find its face.
  struct Quiet {
    Affine place;       ///< nodes of the field from index, at the last visit
    float room = 0.0f;  ///< [voxel edges] by which a distance to the tool may fall before the next visit; 0: it must be visited
    bool far = false;   ///< no voxel was within the band: this holds whatever is known of the block
  };
  using QuietParts = std::array<Quiet, 8>;
  [[nodiscard]] Sweep aim(const Voxmap& voxmap, const Affine& index_from_tool, const Vec3& reaction);
  void visit(Voxmap& voxmap, const Sweep& sweep, const Vec3i& at);
  [[nodiscard]] bool is_quiet(const Sweep& sweep, const Vec3i& at, const Quiet& part, bool has_block) const noexcept;
  /// @returns the search of a block. @param box the part of the block that may be eroded. @param block null: it has no nodes yet. @param
  /// parts null: all parts are searched; else those that are quiet are left out.
  [[nodiscard]] BlockSearch search_of(const MasterWindow& window, const Sweep& sweep, const VoxelBox& box, const CutSurface::Block* block,
                                      const QuietParts* parts);
  /// Notes which parts of a block need no visit.
  void note_quiet(const Sweep& sweep, const BlockSearch& search, bool has_block, QuietParts& parts) const noexcept;
  void complete(const Voxmap& voxmap, const Vec3i& at, CutSurface::Block& block);
  /// Sets phi of the nodes that the search of a block found without, and lowers the room of their parts.
  void start_lacking(const Voxmap& voxmap, const Sweep& sweep, const Vec3i& at, const BlockSearch& search, CutSurface::Block& block);
  void start(const Voxmap& voxmap, const Sweep& sweep, const Vec3i& voxel, const Vec3f& place, float tool, CutSurface::Block& block,
             std::size_t inside) const noexcept;
  [[nodiscard]] bool faces_tool(const Record16& record, const Vec3f& place) const noexcept;
  [[nodiscard]] float from_neighbour(const Voxmap& voxmap, const Sweep& sweep, const Vec3i& voxel, const Vec3f& place) const noexcept;
  void note_earlier_cuts();
  void renew_normals();

  /// The nodes from `first` on, up to the next run, are of one block.
  struct Run {
    CutSurface::Block* block;
    std::size_t first;
  };

  std::shared_ptr<const CuttingField> field_;
  FieldSampler sampler_;
  FaceTool tool_;
  std::optional<SurfaceReader> surface_;  // made at the first step, when the bone is known
  std::vector<Record16> scratch_;
  std::unordered_map<std::uint64_t, QuietParts> quiet_;  // by key_of_block()
  double steepest_;                                      // [-] largest change of an interpolated distance over the way
  BlockFound found_;
  std::array<float, kBlockVoxels> occupancy_, remaining_;  // of a block that is partly outside the window
  FaceNodes nodes_;
  std::vector<Run> runs_;
  std::vector<Buried> buried_;
  std::vector<std::pair<float*, float>> unknown_;  // phi of nodes without a known distance, and that to the tool [voxel edges]
  std::vector<float> shares_, after_, back_;       // of the nodes; after_ and back_ are the results of recede_nodes()
  std::vector<std::int16_t> steps_;                // [steps] of kRecord16Distance, of the nodes after keep()
  std::vector<std::pair<CutSurface::Block*, std::uint32_t>> turned_;  // nodes that need a new normal
  FieldPlaces asked_;                                                 // places of their faces
  std::array<std::vector<std::int16_t>, 3> normals_;
  float edge_ = 0.0f;           // [m]
  float longest_ = 0.0f;        // [voxel edges] largest lag that is searched for
  float usual_ = 0.0f;          // [voxel edges] mean lag of the last step
  Vec3f along_{0.0f};           // [nodes per voxel edge] u
  Mat3 normal_from_node_{1.0};  // direction in the bone frame from a gradient in nodes
};

}  // namespace burrhole
