/// tests/support/dicom_writer.h: DICOM files made by tests. Shares no code with the reader, and can write what no scanner should.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole::test {

inline constexpr const char* kImplicitLittle = "1.2.840.10008.1.2";
inline constexpr const char* kExplicitLittle = "1.2.840.10008.1.2.1";
inline constexpr const char* kExplicitBig = "1.2.840.10008.1.2.2";
inline constexpr const char* kRleLossless = "1.2.840.10008.1.2.5";

/// A data set, element by element, in any order; written in order of tags.
class DicomData {
 public:
  DicomData& text(std::uint32_t tag, const char* vr, const std::string& value) { return put(tag, vr, value); }
  DicomData& numbers(std::uint32_t tag, const char* vr, const std::vector<std::uint16_t>& value) { return put(tag, vr, value); }
  DicomData& items(std::uint32_t tag, const std::vector<DicomData>& value) { return put(tag, "SQ", value); }
  /// Pixels as they are: words of 1, 2 or 4 bytes in little-endian order, turned round for big-endian files.
  DicomData& pixels(const char* vr, int word_bytes, const std::string& little_endian);
  /// Pixels in pieces, undefined length; the first piece is the (empty) table of offsets.
  DicomData& pieces(const std::vector<std::string>& fragments);
  DicomData& erase(std::uint32_t tag);
  [[nodiscard]] std::string file(const std::string& transfer_syntax = kExplicitLittle) const;
  void write(const std::string& path, const std::string& transfer_syntax = kExplicitLittle) const;

 private:
  struct Words {
    int bytes = 2;
    std::string little_endian;
  };
  struct Pieces {
    std::vector<std::string> fragments;
  };
  struct Element {
    std::string vr;
    std::variant<std::string, std::vector<std::uint16_t>, std::vector<DicomData>, Words, Pieces> value;
  };
  template <class T>
  DicomData& put(std::uint32_t tag, const char* vr, const T& value) {
    elements_[tag] = Element{vr, value};
    return *this;
  }
  [[nodiscard]] std::string bytes(bool is_explicit, bool big_endian) const;
  [[nodiscard]] static std::string value_bytes(const Element& element, bool is_explicit, bool big_endian);

  std::map<std::uint32_t, Element> elements_;
};

/// A CT slice of 16-bit signed pixels, HU = stored - 1024; a test changes what it is about.
struct CtSlice {
  int columns = 6, rows = 5;
  Vec3 position{0.0};  ///< [mm]
  Vec3 row{1, 0, 0}, column{0, 1, 0};
  double column_spacing = 0.5, row_spacing = 0.75, thickness = 1.0;  ///< [mm]
  int number = 1;                                                    ///< of the series
  std::string series = "1.2.3", instance = "1.2.3.1";
  std::function<int(int, int)> stored = [](int, int) { return 1024; };  ///< of (i, j)
};

/// Text of DS numbers with all digits of a double.
[[nodiscard]] std::string decimals(const std::vector<double>& values);
[[nodiscard]] std::string words16(const std::vector<int>& values);
[[nodiscard]] DicomData ct_slice(const CtSlice& slice);
/// A multi-frame CT without pixels: frames at the given heights [mm], frame n with a rescale intercept of n.
[[nodiscard]] DicomData ct_frames(const CtSlice& slice, const std::vector<double>& heights);
void write_bytes(const std::string& path, const std::string& bytes);
[[nodiscard]] std::string read_bytes(const std::string& path);

}  // namespace burrhole::test
