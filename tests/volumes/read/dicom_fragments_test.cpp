// Compressed DICOM as scanners and archives write it: padding behind the end of an image, frames in several fragments.
#include <doctest/doctest.h>

#include <filesystem>

#include "tests/support/dicom_writer.h"
#include "tests/support/real_data.h"
#include "tests/support/temporary_folder.h"
#include "volumes/read/scan.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

const CtSlice kSlice{.columns = 512, .rows = 512};

struct Coded {
  std::string syntax, stream;
};

/// The compressed image of a file of one slice: pixel data of undefined length, an empty table of offsets, one fragment.
Coded coded_slice(const std::string& name, const std::string& syntax) {
  for (const auto& entry : std::filesystem::directory_iterator(real_data("dicom_transfer_syntaxes"))) {
    if (entry.path().filename().string().find(name) == std::string::npos) continue;
    const std::string whole = read_bytes(entry.path().string());
    const std::size_t pixels = whole.rfind(std::string("\xe0\x7f\x10\x00O", 5));
    REQUIRE(pixels != std::string::npos);
    const auto length_at = [&](std::size_t item) {
      std::size_t v = 0;
      for (std::size_t b = 4; b-- > 0;) v = v << 8 | static_cast<unsigned char>(whole[item + 4 + b]);
      return v;
    };
    const std::size_t table = pixels + 12, item = table + 8 + length_at(table);
    return {syntax, whole.substr(item + 8, length_at(item))};
  }
  FAIL("no file with " << name);
  return {};
}

std::vector<Coded> coded_slices() {
  return {coded_slice("JPEG2000LosslessOnly", "1.2.840.10008.1.2.4.90"), coded_slice("JPEGLSLossless", "1.2.840.10008.1.2.4.80"),
          coded_slice("JPEGProcess14SV1", "1.2.840.10008.1.2.4.70")};
}

std::string trimmed(std::string stream) {
  while (stream.back() == '\0') stream.pop_back();
  return stream;
}

std::vector<float> values_of(DicomData data, const std::vector<std::string>& fragments, const std::string& syntax) {
  const TemporaryFolder folder;
  data.pieces(fragments).write(folder.file("a.dcm"), syntax);
  auto out = read_dicom(folder.file("a.dcm"), {});
  REQUIRE_MESSAGE(out.ok(), (out ? "" : out.error().text()));
  return std::move(out->scan.values);
}

/// A stream in pieces of even length.
std::vector<std::string> split(const std::string& stream, std::size_t pieces) {
  std::vector<std::string> out;
  const std::size_t each = stream.size() / pieces / 2 * 2;
  for (std::size_t n = 0; n < pieces; ++n) out.push_back(stream.substr(n * each, n + 1 < pieces ? each : std::string::npos));
  return out;
}

}  // namespace

TEST_CASE("read_dicom: bytes that fill up a compressed image behind its end marker change nothing") {
  for (const Coded& coded : coded_slices()) {
    CAPTURE(coded.syntax);
    const std::string bare = trimmed(coded.stream);
    const std::vector<float> whole = values_of(ct_slice(kSlice), {bare}, coded.syntax);
    for (const std::string& padding : {std::string("\xff"), std::string("\xff\0", 2), std::string("\0\xff", 2), std::string(3, '\0')}) {
      CAPTURE(padding.size());
      CHECK(values_of(ct_slice(kSlice), {bare + padding}, coded.syntax) == whole);
    }
  }
}

TEST_CASE("read_dicom: frames in several fragments without a table of offsets are separated where images begin") {
  for (const Coded& coded : coded_slices()) {
    CAPTURE(coded.syntax);
    const std::string bare = trimmed(coded.stream);
    const std::vector<float> one = values_of(ct_frames(kSlice, {0.0}), {bare}, coded.syntax);
    std::vector<std::string> fragments = split(bare, 3);
    for (const std::string& piece : split(bare, 2)) fragments.push_back(piece);
    const std::vector<float> two = values_of(ct_frames(kSlice, {0.0, 1.0}), fragments, coded.syntax);
    REQUIRE(two.size() == 2 * one.size());
    std::size_t wrong = 0;
    for (std::size_t n = 0; n < one.size(); ++n) wrong += two[n] != one[n] || (one[n] > -1024.0f && two[one.size() + n] != one[n] + 1.0f);
    CHECK(wrong == 0);
  }
}

TEST_CASE("read_dicom: fragments that begin fewer images than there are frames are refused with the numbers") {
  const Coded coded = coded_slice("JPEGProcess14SV1", "1.2.840.10008.1.2.4.70");
  const TemporaryFolder folder;
  ct_frames(kSlice, {0.0, 1.0}).pieces(split(trimmed(coded.stream), 3)).write(folder.file("a.dcm"), coded.syntax);
  const auto out = read_dicom(folder.file("a.dcm"), {});
  REQUIRE_FALSE(out.ok());
  CHECK(out.error().message == "3 compressed fragments for 2 frames: there is no offset table, and 1 of the fragments begin an image");
}
