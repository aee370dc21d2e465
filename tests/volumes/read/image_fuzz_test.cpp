#include <doctest/doctest.h>
#include <rapidcheck.h>
#include <sys/resource.h>

#include <cstdlib>
#include <functional>

#include "tests/support/temporary_folder.h"
#include "tests/volumes/read/volume_files.h"
#include "volumes/read/meta_header.h"
#include "volumes/read/nifti_header.h"
#include "volumes/read/nrrd_header.h"
#include "volumes/read/raw_sidecar.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

// The same inputs on every run; RC_PARAMS in the environment asks for others. rapidcheck prints the seed with each property.
const int kSeeded = ::setenv("RC_PARAMS", "seed=20070405 max_success=1000", 0);

/// Any reader of bytes: the fault, or nothing when it took them.
using Take = std::function<std::optional<Error>(const std::string&)>;

/// A few bits of the text turned, or a stretch dropped, doubled or overwritten.
std::string damaged(std::string bytes) {
  const int changes = *rc::gen::inRange(1, 6);
  for (int n = 0; n < changes && !bytes.empty(); ++n) {
    const std::size_t at = *rc::gen::inRange<std::size_t>(0, bytes.size());
    const std::size_t length = std::min(bytes.size() - at, *rc::gen::inRange<std::size_t>(1, 12));
    switch (*rc::gen::inRange(0, 8)) {
      case 0:
        bytes.erase(at, length);
        break;
      case 1:
        bytes.insert(at, bytes.substr(at, length));
        break;
      case 2:
        bytes[at] = *rc::gen::arbitrary<char>();
        break;
      case 3:
        bytes.insert(at, *rc::gen::element<std::string>("9999999999", "-1", "nan", "1e308", "%d", "\n", " = ", ": ", "(", "LIST\n", "\0"));
        break;
      default:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << *rc::gen::inRange(0, 8)));
    }
  }
  return bytes;
}

/// Whatever the damage: taken, or bad_input in one line.
/// @param rounds damaged texts a success, of which rapidcheck asks for a thousand.
void check_property(const std::string& name, const std::vector<std::string>& originals, int rounds, const Take& take) {
  REQUIRE(kSeeded == 0);
  for (const std::string& original : originals) REQUIRE_FALSE(take(original));
  int refused = 0, taken = 0;
  CHECK(rc::check(name, [&] {
    for (int round = 0; round < rounds; ++round) {
      const std::string& original = originals[*rc::gen::inRange<std::size_t>(0, originals.size())];
      const auto error = take(damaged(original));
      ++(error ? refused : taken);
      if (!error) continue;
      // the sidecar's TOML rules have a code of their own for numbers outside their range
      RC_ASSERT(error->code == ErrorCode::bad_input || error->code == ErrorCode::out_of_range);
      RC_ASSERT(!error->message.empty());
      RC_ASSERT(error->text().find_first_of("\r\n") == std::string::npos);
    }
  }));
  MESSAGE(name, ": ", refused, " refused, ", taken, " taken");
  CHECK(refused > 100);  // damage that nobody ever notices would prove nothing
}

template <class T>
std::optional<Error> fault(const Result<T>& result) {
  return result ? std::nullopt : std::optional(result.error());
}

/// A whole file through its reader. What it takes must be consistent.
Take through_file(Result<ReadScan> (*read)(const std::string&, const ReadOptions&), const TemporaryFolder& folder,
                  const std::string& name) {
  return [=, path = folder.file(name)](const std::string& bytes) -> std::optional<Error> {
    write_bytes(path, bytes);
    const auto result = read(path, {});
    if (!result) return result.error();
    const Scan& scan = result.value().scan;
    if (scan.values.size() != VoxelBox{Vec3i(0), scan.dims}.count()) return Error{ErrorCode::internal, "inconsistent", ""};
    return std::nullopt;
  };
}

}  // namespace

TEST_CASE("parse_nifti: damaged headers are taken or refused, whatever the damage") {
  const SmallVolume v = small_volume();
  std::vector<std::string> originals;
  for (const int version : {1, 2})
    for (const bool big : {false, true}) originals.push_back(nifti_header(v, {.version = version, .big = big, .qform = 1}));
  check_property("NIfTI headers", originals, 5,
                 [](const std::string& bytes) { return fault(parse_nifti(std::as_bytes(std::span(bytes)))); });
}

TEST_CASE("parse_nrrd and parse_metaimage: damaged headers are taken or refused, whatever the damage") {
  const SmallVolume v = small_volume();
  check_property("NRRD headers",
                 {nrrd_header(v, "short", "little", "raw") + "\n", nrrd_header(v, "float", "big", "gzip") + "data file: s%03d.raw 1 4 1\n",
                  nrrd_header(v, "short", "little", "raw") + "byte skip: -1\ndata file: LIST\na\nb\n"},
                 5, [](const std::string& text) { return fault(parse_nrrd(text)); });
  check_property("MetaImage headers",
                 {meta_header(v, "MET_SHORT", false, false, "LOCAL"), meta_header(v, "MET_SHORT", true, false, "s%02d.raw 1 4 1"),
                  "HeaderSize = -1\n" + meta_header(v, "MET_SHORT", true, false, "LIST\na\nb")},
                 5, [](const std::string& text) { return fault(parse_metaimage(text)); });
}

TEST_CASE("parse_raw_sidecar: damaged sidecars are taken or refused, whatever the damage") {
  check_property("raw sidecars", {raw_sidecar(small_volume(), "big", "files = \"CT.*\"\nslope = 2.0\nassumed = \"mm\"")}, 5,
                 [](const std::string& text) -> std::optional<Error> {
                   const auto document = TomlDocument::parse(text, "v.toml");
                   if (!document) return document.error();
                   return fault(parse_raw_sidecar(document.value()));
                 });
}

TEST_CASE("readers: damaged files are read whole or refused, and never believed about their size") {
  const TemporaryFolder folder;
  const SmallVolume v = small_volume();
  const std::string voxels = stored<std::int16_t>(v.values, false);
  check_property("NIfTI files",
                 {nifti_header(v, {}) + voxels, gzip(nifti_header(v, {}) + voxels), nifti_header(v, {.version = 2}) + voxels}, 1,
                 through_file(read_nifti, folder, "f.nii"));
  check_property(
      "NRRD files",
      {nrrd_header(v, "short", "little", "raw") + "\n" + voxels, nrrd_header(v, "short", "little", "gzip") + "\n" + gzip(voxels)}, 1,
      through_file(read_nrrd, folder, "f.nrrd"));
  check_property("MetaImage files",
                 {meta_header(v, "MET_SHORT", false, false, "LOCAL") + voxels,
                  meta_header(v, "MET_SHORT", false, true, "LOCAL") + zlib_packed(voxels)},
                 1, through_file(read_metaimage, folder, "f.mha"));
  rusage used{};
  REQUIRE(getrusage(RUSAGE_SELF, &used) == 0);
  CHECK(used.ru_maxrss < 1024 * 1024);  // [KiB] the most this program ever held: every file here is under a kilobyte
}
