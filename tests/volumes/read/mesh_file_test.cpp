#include "volumes/read/mesh_file.h"
#include "tests/support/real_data.h"

#include <doctest/doctest.h>

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>

#include "core/base/random.h"
#include "tests/support/mesh_samples.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr MeshForm kForms[] = {MeshForm::stl_binary, MeshForm::stl_text, MeshForm::obj, MeshForm::ply};

std::string fault_of(const std::string& path) {
  const auto mesh = read_mesh(path, 1e-3);
  if (mesh) return "";
  CHECK(mesh.error().code == ErrorCode::bad_input);
  CHECK(mesh.error().place == path);
  CHECK(mesh.error().message.find('\n') == std::string::npos);
  return mesh.error().message;
}

std::string error_of_bytes(const TemporaryFolder& folder, const std::string& name, const std::string& bytes) {
  write_file(folder.file(name), bytes);
  return fault_of(folder.file(name));
}

/// Most memory this process has held so far [bytes].
double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024.0;
}

const std::string kObjBox = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

}  // namespace

TEST_CASE("read_mesh: STL, OBJ and PLY give the same surface, welded and scaled") {
  const TemporaryFolder folder;
  const SurfaceMesh sphere = sphere_mesh({0.01, -0.02, 0.03}, 0.02, 3);
  const MeshCheck expected = check_mesh(sphere);
  for (const MeshForm form : kForms)
    for (const double unit : {1e-3, 1e-2, 1.0}) {
      CAPTURE(static_cast<int>(form));
      const auto mesh = read_mesh(write_mesh(folder.file("sphere"), sphere, form, unit), unit);
      REQUIRE_MESSAGE(mesh.ok(), (mesh ? "" : mesh.error().text()));
      CHECK(mesh->positions.size() == sphere.positions.size());
      CHECK(mesh->indices.size() == sphere.indices.size());
      const MeshCheck check = check_mesh(*mesh);
      // Float coordinates: 2^-24 of up to 0.05 m; the volume is as exact relative to the radius, three times over.
      CHECK(std::abs(check.volume / expected.volume - 1.0) < 3.0 * 0.05 / 0.02 * 6e-8);
      CHECK_FALSE(mesh_error(*mesh));
    }
}

TEST_CASE("read_mesh: polygons are cut into triangles, concave ones too") {
  const TemporaryFolder folder;
  // A prism over an L of area 3, 2 high: volume 6.
  std::string text;
  for (const char* z : {"0", "2"})
    for (const char* xy : {"0 0", "2 0", "2 1", "1 1", "1 2", "0 2"}) text += std::string("v ") + xy + " " + z + "\n";
  text += "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\n";
  for (int n = 0; n < 6; ++n) {
    const auto v = [&](int i) { return " " + std::to_string(i); };
    text += "f" + v(1 + n) + v(1 + (n + 1) % 6) + v(7 + (n + 1) % 6) + v(7 + n) + "\n";
  }
  write_file(folder.file("l.obj"), text);
  const auto mesh = read_mesh(folder.file("l.obj"), 1.0);
  REQUIRE(mesh.ok());
  CHECK_FALSE(mesh_error(*mesh));
  CHECK(std::abs(check_mesh(*mesh).volume - 6.0) < 1e-12);  // small whole numbers: exact but for the division
}

TEST_CASE("read_mesh: CRLF, several objects and unused vertices do no harm") {
  const TemporaryFolder folder;
  std::string crlf;
  for (const char c : "o first\n" + kObjBox + "v 9 9 9\ng second\n") crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  write_file(folder.file("crlf.obj"), crlf);
  const auto mesh = read_mesh(folder.file("crlf.obj"), 1.0);
  REQUIRE(mesh.ok());
  CHECK(mesh->positions.size() == 4);
  CHECK(std::abs(check_mesh(*mesh).volume - 1.0 / 6.0) < 1e-12);
}

TEST_CASE("read_mesh: binary PLY of either byte order, doubles and unknown elements are read") {
  const TemporaryFolder folder;
  for (const bool big : {false, true}) {
    std::string bytes = std::string("ply\r\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") +
                        " 1.0\r\ncomment made by a test\r\nelement material 2\r\nproperty uchar red\r\nproperty list uchar short tags\r\n"
                        "element vertex 4\r\nproperty double x\r\nproperty uchar colour\r\nproperty double y\r\nproperty double z\r\n"
                        "element face 4\r\nproperty uchar colour\r\nproperty list ushort uint vertex_index\r\nend_header\r\n";
    const auto put = [&](auto value) {
      std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
      if (big) std::reverse(raw.begin(), raw.end());
      bytes += raw;
    };
    for (int n = 0; n < 2; ++n) {
      put(std::uint8_t{7});
      put(std::uint8_t{2});
      put(std::int16_t{-1});
      put(std::int16_t{300});
    }
    for (int n = 0; n < 4; ++n) {
      put(n == 1 ? 1.0 : 0.0);
      put(std::uint8_t{9});
      put(n == 2 ? 1.0 : 0.0);
      put(n == 3 ? 1.0 : 0.0);
    }
    for (const auto& face : {std::array{0, 2, 1}, std::array{0, 1, 3}, std::array{1, 2, 3}, std::array{0, 3, 2}}) {
      put(std::uint8_t{9});
      put(std::uint16_t{3});
      for (const int corner : face) put(static_cast<std::uint32_t>(corner));
    }
    write_file(folder.file("a.ply"), bytes);
    const auto mesh = read_mesh(folder.file("a.ply"), 1.0);
    REQUIRE_MESSAGE(mesh.ok(), (mesh ? "" : mesh.error().text()));
    CHECK(std::abs(check_mesh(*mesh).volume - 1.0 / 6.0) < 1e-15);
    CHECK_FALSE(mesh_error(*mesh));
  }
}

TEST_CASE("read_mesh: what is no mesh is refused in one line") {
  const TemporaryFolder folder;
  CHECK(fault_of("/nowhere/a.stl") == "cannot be read: No such file or directory");
  CHECK(fault_of(folder.path().string() + "/x.step") == "is not a supported mesh: .stl, .obj or .ply");
  std::filesystem::create_directory(folder.path() / "folder.stl");
  CHECK(fault_of(folder.file("folder.stl")) == "is a folder: give a file");
  const std::string ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string facet = "solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
  const struct {
    const char* name;
    std::string bytes, error;
  } table[] = {
      {"a.stl", "", "is empty"},
      {"a.stl", std::string(84, '\0'), "holds no triangles"},
      {"a.stl", "abc", "has 3 bytes, too few for an STL"},
      {"a.stl", facet + "endloop\n", "ends without endsolid: cut off?"},
      {"a.stl", facet + "endloop\nendfacet\n", "line 7: a facet of 2 vertices"},
      {"a.stl", facet + "vertex 0 nought 0\n", "line 6: a vertex needs three numbers"},
      {"a.stl", "solid a\nvertex 0 0 0\n", "line 2: unexpected word in a text STL"},
      {"a.obj", "v 0 0 0\nv 1 0 0\n", "holds no triangles"},
      {"a.obj", kObjBox + "f 1 2 9\n", "a face names vertex 9 of 4"},
      {"a.obj", kObjBox + "f 1 2 0\n", "line 9: \"0\" names no vertex"},
      {"a.obj", kObjBox + "f -1 -2 -5\n", "line 9: \"-5\" names no vertex"},
      {"a.obj", kObjBox + "f 1 2\n", "line 9: a face of 2 corners, 3 to 256 are read"},
      {"a.obj", kObjBox + "l 1 2\n", "line 9: points or lines beside faces"},
      {"a.obj", kObjBox + "curv 0 1 1 2\n", "line 9: \"curv\" is not a word of a polygon mesh"},
      {"a.obj", kObjBox + "v 0 0\n", "line 9: a vertex needs three numbers"},
      {"a.obj", kObjBox + "f 1 2 3 \\\n", "ends within a line"},
      {"a.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "holds a vertex that is not finite"},
      {"a.ply", "plain text", "does not begin with a line \"ply\""},
      {"a.ply", ply, "has no end_header"},
      {"a.ply", "ply\nend_header\n", "has no format line"},
      {"a.ply", "ply\nformat cobol 1.0\n", "line 2: \"cobol\" is not a PLY format"},
      {"a.ply", ply + "property list float int a\n", "line 7: a list whose length has no whole type"},
      {"a.ply", ply + "end_header0 0 0\n", "line 7: \"end_header0\" is not a word of a PLY header"},
      {"a.ply", ply + "end_header\n0 0 0\n1 0 0\n0 1 zero\n", "ends within its elements: cut off?"},
      {"a.ply", ply + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
       "a face names vertex 3 of 3"},
      {"a.ply", ply + "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 1\n",
       "holds edge beside faces"},
  };
  for (const auto& row : table) {
    CAPTURE(row.bytes);
    CHECK(error_of_bytes(folder, row.name, row.bytes) == row.error);
  }
}

TEST_CASE("read_mesh: sizes that a header claims are held against the file before memory is taken") {
  const TemporaryFolder folder;
  const double before = peak_memory();
  std::string stl = stl_bytes(box_mesh({1, 1, 1}), 1.0);
  const std::uint32_t absurd = 85'000'000;  // 4.2 GB
  std::memcpy(stl.data() + 80, &absurd, 4);
  CHECK(error_of_bytes(folder, "claims.stl", stl) == "counts 85000000 triangles, which take 4250000084 bytes; it has 684");
  const auto ply = [](const char* vertices, const char* faces, const char* format) {
    return std::string("ply\nformat ") + format + " 1.0\nelement vertex " + vertices +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
           "\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  };
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    CHECK(error_of_bytes(folder, "v.ply", ply("4000000000", "1", format)).rfind("counts 4000000000 of element vertex, more than its ", 0) ==
          0);
    CHECK(error_of_bytes(folder, "f.ply", ply("3", "4000000000", format)).rfind("counts ", 0) == 0);
    // (In the binary ones the three vertices already take more than the text that follows.)
    CHECK(error_of_bytes(folder, "n.ply", ply("-3", "1", format)) == "line 3: an element without a count");
  }
  // A list that claims four thousand million corners in a file of a few bytes.
  std::string list = ply("3", "1", "binary_little_endian");
  list.replace(list.find("uchar"), 5, "uint");
  list.replace(list.find("end_header\n") + 11, std::string::npos, std::string(36, '\0') + std::string(4, '\xff') + std::string(60, '\0'));
  CHECK(error_of_bytes(folder, "list.ply", list) == "a list of 4.29497e+09 numbers in 60 bytes");
  // 1 GiB is what small bad files may take; the sanitizer's own memory is not counted, as all is well before it.
  CHECK(peak_memory() - before < 1073741824.0);
}

TEST_CASE("read_mesh: cut and damaged files end in a refusal or a mesh, never in a crash") {
  const TemporaryFolder folder;
  const double before = peak_memory();
  const SurfaceMesh sphere = sphere_mesh({0, 0, 0}, 0.02, 2);
  constexpr std::uint64_t kSeed = 5;
  std::size_t read = 0, refused = 0, closed_cuts = 0;
  for (const MeshForm form : kForms) {
    const std::string bytes = mesh_bytes(sphere, form, 1e-3), name = std::string("bad") + ending_of(form);
    for (std::uint64_t n = 0; n < 40; ++n) {
      std::string bad = bytes;
      const bool cut = n < 20;
      if (cut) {
        bad.resize(bytes.size() * n / 20 + 1);
      } else {
        for (std::uint64_t m = 0; m < 5; ++m) {
          const double where = uniform01(kSeed, 100 * n + 2 * m);
          bad[static_cast<std::size_t>(where * where * static_cast<double>(bytes.size()))] =
              static_cast<char>(static_cast<int>(256.0 * uniform01(kSeed, 100 * n + 2 * m + 1)));
        }
      }
      write_file(folder.file(name), bad);
      const auto mesh = read_mesh(folder.file(name), 1e-3);
      ++(mesh ? read : refused);
      if (mesh && cut && !mesh_error(*mesh)) ++closed_cuts;
    }
  }
  MESSAGE(read << " of 160 damaged files gave a mesh, " << refused << " were refused");
  CHECK(closed_cuts == 0);  // nothing that lacks its end passes for a solid
  CHECK(refused > 40);
  CHECK(peak_memory() - before < 1073741824.0);
}

TEST_CASE("read_mesh: real files have the triangles, holes and parts their makers say") {
  const std::string data = real_data("meshes").string();
  struct Row {
    const char* file;
    double unit;  // [m]
    std::size_t vertices, triangles, parts;
    Vec3 size;  // [m]
  };
  for (const Row& row : {Row{"skull.obj", 0.01, 49999, 100002, 1, {0.08688, 0.13903, 0.12112}},
                         Row{"footbones.ply", 0.0254, 2154, 4204, 26, 0.0254 * Vec3(11.266, 3.721, 4.251)},
                         Row{"apple.stl", 1.0, 3129, 6254, 1, {0.087, 0.082, 0.099}}}) {
    CAPTURE(row.file);
    const auto mesh = read_mesh(data + "/" + row.file, row.unit);
    REQUIRE_MESSAGE(mesh.ok(), (mesh ? "" : mesh.error().text()));
    const MeshCheck check = check_mesh(*mesh);
    CHECK(mesh->positions.size() == row.vertices);
    CHECK(check.triangles == row.triangles);
    CHECK(check.parts == row.parts);
    CHECK(check.open_edges == 0);
    MESSAGE(std::string(row.file) << ": " << check.volume * 1e6 << " cm3, fault: " << mesh_error(*mesh).value_or("none"));
    Vec3 lo = mesh->positions[0], hi = lo;
    for (const Vec3& p : mesh->positions) {
      lo = glm::min(lo, p);
      hi = glm::max(hi, p);
    }
    for (std::size_t x = 0; x < 3; ++x)
      CHECK(std::abs((hi - lo)[x] - row.size[x]) < 0.6e-3 * std::max(row.unit, 0.01) * 100.0);  // as rounded
  }
}
