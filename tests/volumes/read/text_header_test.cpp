#include <doctest/doctest.h>

#include "core/base/units.h"
#include "tests/volumes/read/volume_files.h"
#include "volumes/read/meta_header.h"
#include "volumes/read/nrrd_header.h"
#include "volumes/read/raw_sidecar.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

// Text with shortest exact digits; unit times length is one rounding of 1e-16 on 1.3 mm, then one of the factor 1e-3.
constexpr double kRounding = 1e-15;  // [m]

double apart(const Affine& a, const Affine& b_mm) {
  double farthest = glm::length(a.offset - b_mm.offset * kMillimetre);
  for (std::size_t n = 0; n < 3; ++n) farthest = std::max(farthest, glm::length(a.linear[n] - b_mm.linear[n] * kMillimetre));
  return farthest;
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string without(std::string text, const std::string& line_start) {
  const std::size_t at = text.find("\n" + line_start) + 1;
  REQUIRE(at != 0);
  return text.erase(at, text.find('\n', at) + 1 - at);
}

std::string with(std::string text, const std::string& line_start, const std::string& line) {
  text = without(text, line_start);
  return text.insert(text.find('\n') + 1, line + "\n");
}

template <class Header>
std::string fault_of(const Result<Header>& header) {
  REQUIRE_FALSE(header.ok());
  CHECK(header.error().code == ErrorCode::bad_input);
  CHECK(header.error().message.find_first_of("\r\n") == std::string::npos);
  return header.error().message;
}

const std::string kNrrd = nrrd_header(small_volume(), "short", "big", "raw");
const std::string kMeta = meta_header(small_volume(), "MET_SHORT", true, false, "LOCAL");

Result<RawSidecar> sidecar(const std::string& text) {
  const auto document = TomlDocument::parse(text, "v.toml");
  REQUIRE(document.ok());
  return parse_raw_sidecar(document.value());
}

}  // namespace

TEST_CASE("parse_nrrd: every field that places the volume, with LF and CR LF") {
  for (const bool crlf : {false, true}) {
    std::string text = kNrrd + "\n";
    if (crlf)
      for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 2)) text.insert(at, "\r");
    const auto header = parse_nrrd(text + "voxels");
    REQUIRE(header.ok());
    CHECK(header->image.dims == small_volume().dims);
    CHECK(header->image.form.type == PixelType::i16);
    CHECK(header->image.form.big_endian);
    CHECK(header->header_bytes == text.size());
    CHECK(apart(header->image.bone_from_index, small_volume().lps_mm) < kRounding);
    CHECK(header->image.assumed.empty());
  }
}

TEST_CASE("parse_nrrd: RAS and LAS come to the same place as LPS") {
  const Vec3 point(1, 2, 3);
  const auto place = [&](const std::string& space) {
    const auto header = parse_nrrd(with(kNrrd, "space:", "space: " + space));
    REQUIRE(header.ok());
    return header->image.bone_from_index * point;
  };
  const Vec3 lps = place("LPS");
  CHECK(place("right-anterior-superior") == Vec3(-lps.x, -lps.y, lps.z));
  CHECK(place("RAS") == Vec3(-lps.x, -lps.y, lps.z));
  CHECK(place("left-anterior-superior") == Vec3(lps.x, -lps.y, lps.z));
  CHECK(place("scanner-xyz") == lps);
  CHECK(parse_nrrd(with(kNrrd, "space:", "space: scanner-xyz"))->image.assumed.size() == 1);
  CHECK(holds(fault_of(parse_nrrd(with(kNrrd, "space:", "space: LPST"))), "4D"));
}

TEST_CASE("parse_nrrd: what the file does not say is reported") {
  std::string bare = without(without(without(without(kNrrd, "space:"), "space directions:"), "space units:"), "space origin:");
  const auto header = parse_nrrd(bare);
  REQUIRE(header.ok());
  CHECK(header->image.assumed.size() == 4);  // space, spacing, unit, origin
  const auto spaced = parse_nrrd(bare + "spacings: 0.5 0.5 2\nunits: \"cm\" \"cm\" \"mm\"\n");
  REQUIRE(spaced.ok());
  CHECK(apart(spaced->image.bone_from_index, {Mat3(Vec3(5, 0, 0), Vec3(0, 5, 0), Vec3(0, 0, 2)), Vec3(0)}) < kRounding);
}

TEST_CASE("parse_nrrd: three or four numbers along an axis of a picture may be colours, unless the file says that they are slices") {
  const std::string bare = "NRRD0004\ntype: uchar\ndimension: 3\nencoding: raw\n";
  for (const char* sizes : {"3 64 48", "64 48 3", "4 64 48"})
    CHECK(holds(fault_of(parse_nrrd(bare + "sizes: " + sizes + "\n")), "may be colours"));
  CHECK(parse_nrrd(bare + "sizes: 64 48 5\n").ok());
  CHECK(parse_nrrd(bare + "sizes: 64 48 3\nkinds: domain domain domain\n").ok());
  CHECK(parse_nrrd(bare + "sizes: 64 48 3\nspace: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,5)\n").ok());
  CHECK(parse_nrrd(bare + "sizes: 7 5 4\n").ok());  // no picture is so small
}

TEST_CASE("parse_nrrd: what is no volume of plain numbers, or packed another way, is refused by name") {
  CHECK(holds(fault_of(parse_nrrd(with(kNrrd, "encoding:", "encoding: bzip2"))), "gzip"));
  CHECK(holds(fault_of(parse_nrrd(with(kNrrd, "encoding:", "encoding: hex"))), "encoding"));
  CHECK(holds(fault_of(parse_nrrd(with(kNrrd, "dimension:", "dimension: 4"))), "dimension 4"));
  CHECK(holds(fault_of(parse_nrrd(with(kNrrd, "kinds:", "kinds: RGB-color domain domain"))), "axis 1"));
  CHECK(holds(fault_of(parse_nrrd(with(kNrrd, "space directions:", "space directions: none (1,0,0) (0,1,0)"))), "none"));
  CHECK(holds(fault_of(parse_nrrd(with(kNrrd, "space directions:", "space directions: (1,0,nan) (0,1,0) (0,0,1)"))), "vector 1"));
  CHECK(holds(fault_of(parse_nrrd(without(kNrrd, "endian:"))), "endian"));
  CHECK(holds(fault_of(parse_nrrd(with(kNrrd, "type:", "type: block"))), "type"));
  CHECK(holds(fault_of(parse_nrrd(with(kNrrd, "sizes:", "sizes: 7 5"))), "sizes"));
  CHECK(holds(fault_of(parse_nrrd(with(kNrrd, "sizes:", "sizes: 7 5 -4"))), "-4"));
  CHECK(holds(fault_of(parse_nrrd(with(kNrrd, "space units:", "space units: \"ly\" \"mm\" \"mm\""))), "unit of axis x"));
  CHECK(holds(fault_of(parse_nrrd(kNrrd + "sizes: 1 2 3\n")), "repeats a field"));
  CHECK(holds(fault_of(parse_nrrd("NRRD0009\n")), "version"));
  CHECK(holds(fault_of(parse_nrrd("")), "NRRD"));
}

TEST_CASE("parse_nrrd: data files by name, by list and by number") {
  const auto one = parse_nrrd(kNrrd + "data file: my ball.raw\nbyte skip: -1\n");
  CHECK(one->data_files == std::vector<std::string>{"my ball.raw"});
  CHECK(one->at_end);
  const auto list = parse_nrrd(kNrrd + "data file: LIST\na.raw\nb.raw\n");
  CHECK(list->data_files == std::vector<std::string>{"a.raw", "b.raw"});
  const auto numbered = parse_nrrd(kNrrd + "data file: s%03d.raw 4 1 -1\n");
  REQUIRE(numbered->numbered);
  CHECK(numbered->numbered->count() == 4);
  CHECK(numbered->numbered->name(3) == "s001.raw");
  CHECK_FALSE(parse_nrrd(kNrrd + "data file: s%s.raw 1 4 1\n").ok());
  CHECK_FALSE(parse_nrrd(kNrrd + "data file: s%d.raw 1 4 0\n").ok());
}

TEST_CASE("parse_metaimage: every field that places the volume") {
  const auto header = parse_metaimage(kMeta + "voxels");
  REQUIRE(header.ok());
  CHECK(header->image.dims == small_volume().dims);
  CHECK(header->image.form.type == PixelType::i16);
  CHECK(header->image.form.big_endian);
  CHECK(header->header_bytes == kMeta.size());
  CHECK(header->quantity == Quantity::unknown);
  CHECK(apart(header->image.bone_from_index, small_volume().lps_mm) < kRounding);
  CHECK(header->image.assumed.empty());
  CHECK(parse_metaimage("Modality = MET_MOD_MR\n" + kMeta)->quantity == Quantity::other);
  CHECK(parse_metaimage("Modality = MET_MOD_CT\n" + kMeta)->quantity == Quantity::unknown);
}

TEST_CASE("parse_metaimage: what is assumed is reported, what cannot be read is refused by name") {
  const auto bare = parse_metaimage(without(without(without(kMeta, "TransformMatrix"), "Offset"), "ElementSpacing"));
  REQUIRE(bare.ok());
  CHECK(bare->image.assumed.size() == 3);
  CHECK(holds(fault_of(parse_metaimage(with(kMeta, "NDims", "NDims = 4"))), "4D"));
  CHECK(holds(fault_of(parse_metaimage("ElementNumberOfChannels = 3\n" + kMeta)), "3 channels"));
  CHECK(holds(fault_of(parse_metaimage(with(kMeta, "ElementType", "ElementType = MET_UCHAR_ARRAY"))), "ElementType"));
  CHECK(holds(fault_of(parse_metaimage(with(kMeta, "DimSize", "DimSize = 7 5"))), "DimSize"));
  CHECK(holds(fault_of(parse_metaimage(with(kMeta, "Offset", "Offset = 1 2 inf"))), "Offset"));
  CHECK(holds(fault_of(parse_metaimage(with(kMeta, "BinaryDataByteOrderMSB", "BinaryDataByteOrderMSB = perhaps"))), "True nor False"));
  CHECK(holds(fault_of(parse_metaimage(without(kMeta, "ElementDataFile"))), "ElementDataFile"));
  CHECK(holds(fault_of(parse_metaimage("")), "ElementDataFile"));
  CHECK(holds(fault_of(parse_metaimage("DimSize = 1 1 1\n" + kMeta)), "again"));
}

TEST_CASE("parse_metaimage: a comment may be longer than the 255 bytes beyond which MetaIO 5.2 overruns its buffer") {
  for (const std::size_t length : {300, 100000}) CHECK(parse_metaimage("Comment = " + std::string(length, 'x') + "\n" + kMeta).ok());
}

TEST_CASE("parse_metaimage: lists and numbered names") {
  const std::string meta = without(kMeta, "ElementDataFile");
  CHECK(parse_metaimage(meta + "ElementDataFile = LIST\na.raw\nb.raw\n")->data_files.size() == 2);
  CHECK(parse_metaimage(meta + "ElementDataFile = s%02d.raw 1 4 1\n")->numbered->name(0) == "s01.raw");
  CHECK_FALSE(parse_metaimage(meta + "ElementDataFile = s%02x.raw 1 4 1\n").ok());
}

TEST_CASE("parse_raw_sidecar: every key, and what is not said is reported") {
  const auto full = sidecar(raw_sidecar(small_volume(), "big", "data = \"v.raw\"\nslope = 2\nquantity = \"hounsfield\"\nassumed = \"mm\""));
  REQUIRE(full.ok());
  CHECK(full->image.form.big_endian);
  CHECK(full->image.form.slope == 2.0);
  CHECK(full->quantity == Quantity::hounsfield);
  CHECK(full->image.assumed == std::vector<std::string>{"mm"});
  CHECK(apart(full->image.bone_from_index, small_volume().lps_mm) < kRounding);
  const auto bare = sidecar("data = 'v'\ndims = [1, 2, 3]\ntype = 'uint8'\nspacing_mm = [1, 1, 1]\n");
  REQUIRE(bare.ok());
  CHECK(bare->image.assumed.size() == 2);
}

TEST_CASE("parse_raw_sidecar: every error has its line and column") {
  const auto place_of = [](const std::string& text) {
    const auto result = sidecar(text);
    REQUIRE_FALSE(result.ok());
    return result.error().text();
  };
  const std::string rest = "dims = [1, 2, 3]\ntype = 'uint8'\nspacing_mm = [1, 1, 1]\n";
  CHECK(holds(place_of("dat = 'v'\n" + rest), "v.toml"));
  CHECK(holds(place_of("data = 'v'\nfiles = 'a*'\n" + rest), "v.toml:2:1: files"));
  CHECK(holds(place_of("files = 'a'\n" + rest), "v.toml:1:1: files"));
  CHECK(holds(place_of("files = '../a*'\n" + rest), "v.toml:1:1: files"));
  CHECK(holds(place_of("data = 'v'\ndims = [1.5, 2, 3]\ntype = 'uint8'\nspacing_mm = [1, 1, 1]\n"), "v.toml:2:1: dims"));
  CHECK(place_of("data = 'v'\ndims = [1, 2, 3]\ntype = 'uint8'\nspacing_mm = [1e-5, 1, 1]\n") ==
        "v.toml:4:1: spacing_mm is not read: voxels are 1e-05 mm long on axis i; between 0.001 and 1000 mm is read");
  CHECK(place_of("data = 'v'\n" + rest + "direction = [0, 1, 0, 0, 1, 0, 0, 0, -1]\n") ==
        "v.toml:5:1: direction is not read: two index axes run in the same direction: voxels are flat");
  CHECK(holds(place_of("data = 'v'\ndims = [2000000000, 2000000000, 3]\ntype = 'uint8'\nspacing_mm = [1, 1, 1]\n"), "v.toml:2:1: dims"));
  CHECK(holds(place_of("data = 'v'\ndims = [1, 2, 3]\ntype = 'int16'\nspacing_mm = [1, 1, 1]\n"), "byte_order is missing"));
  CHECK(holds(place_of("data = 'v'\ndims = [1, 2, 3]\ntype = 'short'\nspacing_mm = [1, 1, 1]\n"), "v.toml:3:1: type"));
  CHECK(holds(place_of("data = 'v'\ndirection = [2,0,0, 0,1,0, 0,0,1]\n" + rest), "v.toml:2:"));
  CHECK(holds(place_of("data = 'v'\ndirection = [0.5,0,0, 0,1,0, 0,0,1]\n" + rest), "length 0.5 for i"));
  CHECK(holds(place_of("data = 'v'\nslope = 0\n" + rest), "v.toml:2:1: slope"));
  CHECK(holds(place_of("data = 'v'\nspacing_mm = [1, 0, 1]\ndims = [1, 2, 3]\ntype = 'uint8'\n"), "v.toml:2:18"));
  CHECK(holds(place_of("data = 'v'\nbite_order = 'big'\n" + rest), "did you mean \"byte_order\""));
}
