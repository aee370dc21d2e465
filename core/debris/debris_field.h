/// core/debris/debris_field.h: chips and mist that a bit makes of bone: where they are, and where their volume went.
///   Particle  stands for many chips of one diameter: the diameter sets its drag, the volume what it fills. When the budget is full, particles
///           that lie in one block of 2^3 heap cells are merged in pairs, and new ones are twice as large; the next time in blocks of 4^3. If that frees
///           little, new volume joins a particle that exists. Merging keeps the volume.
///   Way     removed bone is held by the bit (flutes, gap to the wall), which releases a share per revolution; it leaves at the mouth of the hole
///           by the rim of the bit, thrown along the rim. A particle flies (chip_flight.h), and where bone or a full heap cell blocks its way it
///           slides to a lower open cell or settles. What carries it goes: it falls again. A turning bit takes up what lies in its reach; one that
///           stops drops what it holds. Saline rinses (wash.h); suction takes what its inflow lifts; what leaves the site is lost.
///   Balance removed = held + flying + settled + rinsed + sucked + lost + undone, after each step, to rounding.
///   Random  counter-based (core/base/random.h): the same calls give the same bits.
///   Frame   bone.   Units  SI; volumes of solid bone.   Errors  out_of_range from create().   Thread  one. Steps do not allocate.
///   Source  own derivation.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/debris/chip_flight.h"
#include "core/debris/debris_site.h"
#include "core/debris/wash.h"

namespace burrhole {

struct DebrisConfig {
  ChipAir air{};
  std::size_t most_particles = 10000;  ///< [-] >= 1: the budget
  double particle = 0.1e-9;            ///< [m^3] > 0: volume of a particle of chips; one of mist has a tenth (an assumption)
  double chip_ratio = 20.0;            ///< [-] > 0: diameter of a chip over the mean uncut chip thickness (an assumption)
  double smallest = 50e-6;             ///< [m] > 0: least mean diameter of chips (an assumption)
  double largest = 500e-6;             ///< [m] >= smallest: largest mean diameter (an assumption)
  double size_spread = 2.0;            ///< [-] >= 1: diameters lie between the mean over it and times it (an assumption)
  double clearing = 0.05;              ///< [-] > 0: share of what the bit holds that a revolution clears out (an assumption)
  double throw_share = 0.5;            ///< [-] >= 0: mean speed of leaving chips over that of the rim (an assumption)
  double spread = 0.5;                 ///< [-] >= 0: of their directions, outwards and up over along the rim (an assumption)
  double mist_share = 0.01;            ///< [-] in [0, 1]: of the volume, that becomes mist (an assumption)
  double mist_diameter = 15e-6;        ///< [m] > 0 (an assumption)
  double mist_cloud = 8e-3;            ///< [m] >= 0: radius in which the bit stirs it (an assumption)
  double bulk = 2.0;                   ///< [-] >= 1: volume of loose chips over that of their bone (an assumption)
  double rinse_time = 1.0;             ///< [s] > 0: in which saline takes wet chips (an assumption)
  double rinse_load = 0.05;            ///< [-] >= 0: most volume of chips that a volume of saline carries (an assumption)
  std::uint64_t seed = 1;
};

/// One particle.
struct DebrisParticle {
  Vec3 position{0.0};     ///< [m]
  Vec3 velocity{0.0};     ///< [m/s] 0 when settled
  double volume = 0.0;    ///< [m^3]
  double diameter = 0.0;  ///< [m] of its chips
  DebrisBirth birth{};
  std::uint32_t number = 0;  ///< in the order of birth, for pictures
  bool settled = false;
  bool is_mist = false;
};

/// The bit in a step.
struct DebrisBit {
  Vec3 tip{0.0};             ///< [m]
  Vec3 axis{0.0, 0.0, 1.0};  ///< [-] unit, up the shaft
  double radius = 0.0;       ///< [m] of its cutting part
  double height = 0.0;       ///< [m] of its cutting part
  double spin = 0.0;         ///< [rev/s]
};
/// Saline that wets what lies within a ball.
struct DebrisRinse {
  Vec3 centre{0.0};    ///< [m]
  double reach = 0.0;  ///< [m]
  double flow = 0.0;   ///< [m^3/s] 0: none
};
/// A suction nozzle: the inflow at the distance r is flow / (4 pi r^2); what falls more slowly than that within reach is taken.
struct DebrisSuction {
  Vec3 nozzle{0.0};    ///< [m]
  double reach = 0.0;  ///< [m]
  double flow = 0.0;   ///< [m^3/s] of air; 0: off
};
struct DebrisStep {
  double dt = 0.0;         ///< [s] > 0
  double removed = 0.0;    ///< [m^3] bone
  double thickness = 0.0;  ///< [m] mean uncut chip thickness
  std::span<const DebrisBirth> births{};
  DebrisBit bit{};
  DebrisRinse rinse{};
  DebrisSuction suction{};
};

/// Sums since the start.
struct DebrisTotals {
  double removed = 0.0, rinsed = 0.0, sucked = 0.0, lost = 0.0, undone = 0.0;  ///< [m^3]
};

class DebrisField {
 public:
  [[nodiscard]] static Result<DebrisField> create(const DebrisConfig& config, DebrisSite site);
  /// @returns the memory [bytes] of the particles and cells, without those of the site.
  [[nodiscard]] static std::uint64_t bytes_of(const DebrisConfig& config, std::uint64_t cells) noexcept;

  /// The site, for changes of bone; they come before step().
  [[nodiscard]] DebrisSite& site() noexcept { return site_; }
  [[nodiscard]] const DebrisSite& site() const noexcept { return site_; }
  void step(const DebrisStep& now) noexcept;
  /// After bone was brought back: chips of that bone, those that would lie inside bone, and what the bit holds are gone (`undone`).
  void bone_came_back() noexcept;

  [[nodiscard]] std::span<const DebrisParticle> particles() const noexcept { return particles_; }
  [[nodiscard]] const DebrisTotals& totals() const noexcept { return totals_; }
  [[nodiscard]] double held() const noexcept { return held_ + waiting_chips_ + waiting_mist_; }  ///< [m^3] by the bit
  [[nodiscard]] double flying() const noexcept;                                                  ///< [m^3] mist included
  [[nodiscard]] double settled() const noexcept;                                                 ///< [m^3]
  [[nodiscard]] double mist() const noexcept;                                                    ///< [m^3] that flies
  /// @returns |removed - the rest of the balance| / removed; 0 before any.
  [[nodiscard]] double balance_error() const noexcept;
  [[nodiscard]] std::uint64_t merged() const noexcept { return merged_; }  ///< particles that joined others
  [[nodiscard]] std::size_t most() const noexcept { return most_; }        ///< largest number of particles so far
  /// @returns the mean diameter [m] of the chips that were made so far, mist not included, each particle once; 0 before any.
  [[nodiscard]] double mean_diameter() const noexcept { return made_ > 0 ? diameters_ / static_cast<double>(made_) : 0.0; }
  [[nodiscard]] const DebrisConfig& config() const noexcept { return config_; }

  /// @returns the share of a disc, seen along its axis, that settled particles cover. @param centre [m]. @param radius [m] > 0. Tested at the
  /// nodes of a raster of kRaster squared.
  [[nodiscard]] double hidden_share(const Vec3& centre, const Vec3& axis, double radius) const noexcept;
  static constexpr int kRaster = 64;
  /// @returns the radius [m] of the ball that the chips of a particle fill, with the gaps between them.
  [[nodiscard]] double radius_of(const DebrisParticle& one) const noexcept;

 private:
  DebrisField(const DebrisConfig& config, DebrisSite site);
  [[nodiscard]] double random() noexcept;
  void release(const DebrisStep& now) noexcept;
  void drop(const DebrisStep& now) noexcept;
  void emit(double& waiting, double quantum, const DebrisStep& now, bool is_mist) noexcept;
  [[nodiscard]] DebrisParticle born(const DebrisStep& now, bool is_mist) noexcept;
  [[nodiscard]] Vec3 mouth(const DebrisBit& bit, const Vec3& outwards) const noexcept;
  void add(const DebrisParticle& one) noexcept;
  /// Merges settled particles of one block of cells in pairs. @returns how many that freed.
  std::size_t merge_settled() noexcept;
  void take_up(const DebrisBit& bit) noexcept;
  void loosen() noexcept;
  void slide(double dt) noexcept;
  void fly(double dt) noexcept;
  /// @returns whether the particle is still in the site.
  [[nodiscard]] bool fly_one(DebrisParticle& one, double dt) noexcept;
  void land(DebrisParticle& one) noexcept;
  void rinse(const DebrisRinse& saline, double dt) noexcept;
  void suck(const DebrisSuction& suction) noexcept;
  void remove(std::size_t n) noexcept;
  void lift(DebrisParticle& one) noexcept;
  /// What is known of the place of a particle that has settled.
  struct Seat {
    bool known = false;
    bool on_bone = false;               // bone carries it
    std::uint32_t cell = 0, below = 0;  // its own, and that of the place below it
  };
  /// @returns the seat of a settled particle, found if it was not known.
  Seat& seat_of(std::size_t n) noexcept;
  [[nodiscard]] static std::size_t cell_at(std::uint32_t cell) noexcept { return cell == 0xffffffffu ? DebrisSite::kNowhere : cell; }
  void refill() noexcept;

  DebrisConfig config_;
  DebrisSite site_;
  std::vector<DebrisParticle> particles_;
  std::vector<Seat> seats_;           // of the particles
  std::vector<std::uint32_t> first_;  // by heap cell, in merge_settled(): kNone between calls
  double quantum_;                    // [m^3] of a new particle
  double block_ = 1.0;                // [cells] edge of the blocks that merge_settled() merges in
  double held_ = 0.0, waiting_chips_ = 0.0, waiting_mist_ = 0.0;
  double thickness_ = 0.0;  // [m] the last that was cut
  bool holds_ = false, merged_now_ = false;
  std::array<DebrisBirth, LossSampler::kMost> births_{};
  std::size_t birth_count_ = 0;
  DebrisTotals totals_;
  double to_test_ = 0.0;  // [-] particles due in slide()
  std::uint64_t tested_ = 0, drawn_ = 0, merged_ = 0;
  std::uint32_t numbers_ = 0;
  double diameters_ = 0.0;  // [m] sum of all particles of chips
  std::uint64_t made_ = 0;  // such particles
  std::size_t most_ = 0;
};

}  // namespace burrhole
