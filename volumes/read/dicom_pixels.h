/// volumes/read/dicom_pixels.h: the frames of one DICOM file as floats: fragments, decompression, stored bits, slope and intercept.
///   Units   HU where the file has HU.   Errors  bad_input.   Source  PS3.5 sec. 8 and annexes A.4 (encapsulation), G (RLE).
///   Bound   one compressed and one decoded frame in memory.
#pragma once

#include <span>
#include <vector>

#include "volumes/read/dicom_header.h"

namespace burrhole {

/// [HU] value of air and of padding.
inline constexpr float kAirHounsfield = -1024.0f;

struct PixelCounts {
  std::size_t padded = 0;   ///< pixels marked as padding in the file, set to air
  std::size_t clamped = 0;  ///< pixels below -1024 HU, set to -1024 HU
};

/// Converts stored pixels to values. `raw` holds out.size() pixels. With `hounsfield`, padding and values below air become air.
void stored_to_float(std::span<const std::byte> raw, const StoredForm& form, double slope, double intercept, bool hounsfield,
                     std::span<float> out, PixelCounts& counts);

/// Converts an RLE frame to little-endian pixels of `bytes_each`. @returns the error, empty if none.
[[nodiscard]] std::string decode_rle(std::span<const std::byte> coded, std::size_t pixels, std::size_t bytes_each,
                                     std::vector<std::byte>& out);

/// Reads the frames of one file, in any order.
class FrameReader {
 public:
  /// Opens the file again and lists its fragments. @returns bad_input, place = file, if it cannot be read or its fragments are incomplete
  /// or cannot be assigned to frames.
  [[nodiscard]] static Result<FrameReader> open(const DicomHeader& header);
  /// @param out columns*rows values. @returns bad_input, place = file, if the pixels are incomplete or cannot be decoded.
  [[nodiscard]] Status read(std::size_t frame, bool hounsfield, std::span<float> out, PixelCounts& counts);

 private:
  struct Fragment {
    std::uint64_t offset = 0, length = 0;
  };
  FrameReader(const DicomHeader& header, DicomBytes bytes) : header_(&header), bytes_(std::move(bytes)) {}
  [[nodiscard]] std::string list_fragments();
  [[nodiscard]] std::vector<std::size_t> find_starts(const std::vector<Fragment>& fragments);
  [[nodiscard]] std::string share_out(const std::vector<Fragment>& fragments, std::uint64_t first_item,
                                      const std::vector<std::uint32_t>& table);
  [[nodiscard]] std::string read_stored(std::size_t frame, StoredForm& form);
  [[nodiscard]] std::string decode(StoredForm& form);

  const DicomHeader* header_;
  DicomBytes bytes_;
  std::vector<std::vector<Fragment>> frames_;  ///< fragments of each compressed frame
  std::vector<std::byte> coded_, raw_;
};

}  // namespace burrhole
