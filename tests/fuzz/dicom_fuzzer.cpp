// Any bytes as a DICOM file: its elements, its header as plain values and its frames, RLE and the look at JPEG streams included. The file
// lies in memory. GDCM is not built with the fuzzer's instruments and stays out: decode_stream here ends where the codecs would begin.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "volumes/read/dicom_pixels.h"
#include "volumes/read/gdcm_codecs.h"
#include "volumes/read/jpeg_scan.h"

namespace burrhole {

bool decode_stream(DicomCodec codec, std::span<const std::byte> stream, const StreamShape&, std::vector<std::byte>&) {
  if (codec == DicomCodec::jpeg) (void)jpeg_scan_is_whole(plain_jpeg(stream));
  return false;
}

}  // namespace burrhole

namespace {

using namespace burrhole;

constexpr double kMostPixels = 1 << 20;  // of a frame that is decoded: larger ones only take longer

/// One file in memory, written anew for each input. @returns its path.
const std::string& file_of(const std::uint8_t* data, std::size_t size) {
  static const int file = memfd_create("fuzz.dcm", 0);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  if (file < 0 || ftruncate(file, 0) != 0 || pwrite(file, data, size, 0) != static_cast<ssize_t>(size)) std::abort();
  return path;
}

void read_frames(const DicomHeader& header) {
  if (header.columns < 1 || header.rows < 1 || header.frames.empty()) std::abort();
  const double pixels = static_cast<double>(header.columns) * header.rows;
  if (pixels > kMostPixels) return;
  auto reader = FrameReader::open(header);
  if (!reader) return;
  std::vector<float> values(static_cast<std::size_t>(pixels));
  for (std::size_t frame = 0; frame < std::min<std::size_t>(header.frames.size(), 4); ++frame) {
    PixelCounts counts;
    if (!reader->read(frame, header.hounsfield, values, counts)) continue;
    for (const float value : values)
      if (!std::isfinite(value) || (header.hounsfield && value < kAirHounsfield)) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<DicomKeepTag> keep = {{"StudyDescription", 0x00081030, "LO"}, {"Rows", 0x00280010, "US"}};
  const auto header = read_dicom_header(file_of(data, size), keep);
  if (!header) std::abort();  // the file can be opened
  if (starts_like_dicom(std::as_bytes(std::span(data, size))) == (header->skip == "not DICOM")) std::abort();
  if (header->skip.empty() && header->error.empty()) read_frames(*header);
  return 0;
}
