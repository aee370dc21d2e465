/// core/contact/searched_places.h: the places of the tool's surface between its shell points that were searched because bone may be deep
///   there.
///   Frame  tool frame.   Units  SI.   Thread  contact; never allocates.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/contact/contact_place.h"

namespace burrhole {

class SearchedPlaces {
 public:
  static constexpr std::size_t kMost = 64;  ///< a hit beyond is a candidate as the shell point that it is
  struct Place {
    std::uint32_t point = 0;  ///< shell point whose cell was searched
    bool same = false;        ///< the place is that of a kept plane, which stands for it
    bool settled = false;     ///< `contact` has the normal and gap of a plane at this pose
    ContactPlace contact;
  };
  void clear() noexcept { count_ = 0; }
  [[nodiscard]] std::span<Place> list() noexcept { return {places_.data(), count_}; }
  /// @returns false when full.
  bool add(const Place& place) noexcept {
    if (count_ == kMost) return false;
    places_[count_++] = place;
    return true;
  }
  /// Drops places for which keep(place) is false; keep may change the place.
  template <class Keep>
  void refresh(Keep&& keep) noexcept {
    std::size_t kept = 0;
    for (std::size_t n = 0; n < count_; ++n)
      if (keep(places_[n])) places_[kept++] = places_[n];
    count_ = kept;
  }

 private:
  std::array<Place, kMost> places_{};
  std::size_t count_ = 0;
};

}  // namespace burrhole
