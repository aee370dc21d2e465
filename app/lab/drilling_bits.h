/// app/lab/drilling_bits.h: the bits of the drilling studies: shipped ones, pinned shapes that no shipped bit has, and a user's own.
///   Units  SI; the texts are tool files.   Errors  bad_input of a tool file, or for a name that is not in the list.   Thread  any.
#pragma once

#include <string>
#include <vector>

#include "app/lab/oracle/drilled_volume.h"
#include "core/base/result.h"

namespace burrhole {

struct DrillingBit {
  std::string name;
  std::string shipped;           ///< name of a shipped tool; empty: `text`
  std::string text;              ///< tool file of a pinned shape
  SweptBit swept;                ///< of the cutting part, by the trade size
  double widest_at = 0.0;        ///< [m] height above the tip at which the cutting part is at its widest first
  double finest_mm = 0.0;        ///< [mm] smallest voxel edge with which the bit fits into the window of bone
  std::string short_shank = {};  ///< assignment that shortens the shank of a shipped tool, so that it fits
};

/// @returns all bits; the first is the one that the other factors are varied with.
[[nodiscard]] const std::vector<DrillingBit>& drilling_bits();
/// @returns null if there is none of that name.
[[nodiscard]] const DrillingBit* find_drilling_bit(const std::string& name);
/// Makes a bit of a tool file, whose cutting part must revolve: the closed form of its hole is that of its largest cutting radius, and of a crown
/// of its smallest bore. @param name for tables. @returns bad_input for a mesh, a bit that does not cut, or one that is no body of revolution.
[[nodiscard]] Result<DrillingBit> own_drilling_bit(const std::string& name, const std::string& text);
/// @returns the names of drilling_bits(), separated by commas.
[[nodiscard]] std::string drilling_bit_names();
/// @returns the text of the bit's tool file, with a short shank. @param tool_folder of the shipped tools.
[[nodiscard]] Result<std::string> drilling_bit_text(const DrillingBit& bit, const std::string& tool_folder);

}  // namespace burrhole
