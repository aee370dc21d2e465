#include "app/effect/dura_picture.h"

#include <algorithm>
#include <cmath>

#include "app/effect/dura_shell.h"

namespace burrhole {
namespace {

constexpr double kMoved = 5e-6;        // [m] of a node, above which the next picture shows it
constexpr double kTopMoved = 0.1;      // [voxels] of the upper face of soft tissue, above which its voxels are drawn anew
constexpr double kBelowTear = 0.6e-3;  // [m] of the voxels of the brain below the dura round a rent: below the surface of the brain in it
constexpr double kLeastBelow = 1e-4;   // [m] of soft tissue below the upper face
constexpr double kAbove = 2e-3;        // [m] over the sheet at rest, up to which soft tissue is left out
constexpr double kLeastSlope = 0.3;    // [-] of a normal along z; steeper faces count as that

}  // namespace

DuraPicture::DuraPicture(const ElasticSheet& sheet, const Pose& bone_from_sheet, double thickness, double edge)
    : sheet_(&sheet), bone_from_sheet_(bone_from_sheet), sheet_from_bone_(bone_from_sheet.inverse()), thickness_(thickness), edge_(edge) {}

bool DuraPicture::copy_for_picture(bool exactly) {
  const SheetLattice& lattice = sheet_->lattice();
  changed_ = Bounds::none();
  const bool first = x_.empty();
  bool differs = first;
  for (std::size_t n = 0; n < lattice.nodes() && !differs; ++n)
    differs = glm::length(sheet_->position(n) - x_[n]) > (exactly ? 0.0 : kMoved);
  bool torn = first;  // other edges than at the last copy
  for (std::size_t e = 0; e < lattice.edges().size() && !torn; ++e) torn = sheet_->is_broken(e) != (broken_[e] != 0);
  if (!differs && !torn && (!exactly || exact_)) return false;
  exact_ = exactly;
  x_.resize(lattice.nodes());
  for (std::size_t n = 0; n < x_.size(); ++n) x_[n] = sheet_->position(n);
  if (torn) {
    broken_.resize(lattice.edges().size());
    for (std::size_t e = 0; e < broken_.size(); ++e) broken_[e] = sheet_->is_broken(e) ? 1 : 0;
    rent_.emplace(lattice, broken_);
  }
  find_shape();
  // z of the shell over the place of a node at rest, from which the node has moved aside.
  const auto over_rest = [this](std::size_t n) {
    const Vec3 moved = shape_[n] - sheet_->rest(n), &normal = normals_[n];
    const double z = shape_[n].z + (normal.x * moved.x + normal.y * moved.y) / std::max(normal.z, kLeastSlope);
    return std::min(z, sheet_->rest(n).z);
  };
  std::vector<double> wanted(x_.size());
  // Below the shell, so that a cut which opens it shows no vessels of voxels in it, and below its upper face by more than the ramp of the voxels.
  const double below = std::max(thickness_, 0.5 * edge_) + kLeastBelow;
  for (std::size_t n = 0; n < x_.size(); ++n) wanted[n] = over_rest(n) - below;
  for (std::uint32_t n = 0; n < wanted.size(); ++n)
    if (rent_->is_near(n)) wanted[n] = over_rest(n) - thickness_ - kBelowTear;
  lower_soft(wanted, exactly ? 0.0 : kTopMoved * edge_);
  return true;
}

/// Takes over the heights that differ by more than `seen` [m], with the boxes in which voxels change.
void DuraPicture::lower_soft(const std::vector<double>& wanted, double seen) {
  const bool first = top_.empty();
  if (first) top_ = wanted;
  Bounds changed = Bounds::none(), all = Bounds::none();
  const double reach = sheet_->lattice().spacing();
  for (std::size_t n = 0; n < top_.size(); ++n) {
    const Vec3 rest = sheet_->rest(n);
    all.include(rest + Vec3(-reach, -reach, kAbove));
    all.include({rest.x + reach, rest.y + reach, std::min(top_[n], wanted[n]) - 2.0 * edge_});
    if (!first && std::abs(wanted[n] - top_[n]) <= seen) continue;
    changed.include({rest.x - reach, rest.y - reach, std::min(top_[n], wanted[n]) - 2.0 * edge_});
    changed.include({rest.x + reach, rest.y + reach, first ? rest.z + kAbove : std::max(top_[n], wanted[n]) + 2.0 * edge_});
    top_[n] = wanted[n];
  }
  extent_ = bounds_under(bone_from_sheet_, all);
  if (changed.lo.x <= changed.hi.x) changed_ = bounds_under(bone_from_sheet_, changed);
}

double DuraPicture::shown(const Vec3& p_bone, double edge) const {
  const Vec3 p = sheet_from_bone_ * p_bone;
  const auto place = sheet_->lattice().find(p.x, p.y);
  if (!place) return 1.0;
  double top = 0.0, rest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    top += place->weights[k] * top_[place->nodes[k]];
    rest += place->weights[k] * sheet_->rest(place->nodes[k]).z;
  }
  return p.z > rest + kAbove ? 1.0 : std::clamp(0.5 + (top - p.z) / edge, 0.0, 1.0);
}

/// The positions that are drawn, without those of nodes that are joined to nothing, and their normals.
void DuraPicture::find_shape() {
  shape_ = x_;
  if (!rent_->empty()) {
    std::vector<Vec3> moved(x_.size());
    for (std::size_t n = 0; n < x_.size(); ++n) moved[n] = x_[n] - sheet_->rest(n);
    rent_->fill_lost(moved);
    for (std::size_t n = 0; n < x_.size(); ++n) shape_[n] = sheet_->rest(n) + moved[n];
  }
  normals_.assign(x_.size(), Vec3(0.0));
  for_each_triangle(sheet_->lattice(), [&](const DuraRent::Nodes& nodes) {
    const Vec3 normal = glm::cross(shape_[nodes[1]] - shape_[nodes[0]], shape_[nodes[2]] - shape_[nodes[0]]);
    for (const std::uint32_t n : nodes) normals_[n] += normal;
  });
  for (Vec3& normal : normals_) normal = glm::length(normal) > 0.0 ? glm::normalize(normal) : Vec3(0.0, 0.0, 1.0);
}

void DuraPicture::append_mesh(AddedMesh& out) const {
  append_dura({sheet_, &shape_, &normals_, &*rent_, bone_from_sheet_, thickness_}, out);
}

}  // namespace burrhole
