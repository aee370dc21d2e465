/// tests/support/mesh_samples.h: closed meshes made in code, their files, and the generalised winding number as a slow twin of "inside".
#pragma once

#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <numbers>
#include <string>

#include "core/base/bounds.h"
#include "core/tool/surface_mesh.h"

namespace burrhole::test {

/// Icosahedron cut `levels` times, its vertices on the sphere: 20 * 4^levels triangles. A vertex lies at each pole.
inline SurfaceMesh sphere_mesh(const Vec3& centre, double radius, int levels) {
  SurfaceMesh mesh;
  const double z = 1.0 / std::sqrt(5.0), r = 2.0 * z;
  mesh.positions.push_back({0, 0, 1});
  for (int n = 0; n < 10; ++n) {
    const double angle = std::numbers::pi / 5.0 * n;
    mesh.positions.push_back({r * std::cos(angle), r * std::sin(angle), n % 2 == 0 ? z : -z});
  }
  mesh.positions.push_back({0, 0, -1});
  for (std::uint32_t n = 0; n < 10; n += 2) {
    const std::uint32_t a = 1 + n, b = 1 + n + 1, c = 1 + (n + 2) % 10, d = 1 + (n + 3) % 10;
    mesh.indices.insert(mesh.indices.end(), {0, a, c, a, b, c, b, d, c, b, 11, d});
  }
  for (int level = 0; level < levels; ++level) {
    SurfaceMesh finer{mesh.positions, {}};
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [found, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(finer.positions.size()));
      if (fresh) finer.positions.push_back(glm::normalize(mesh.positions[a] + mesh.positions[b]));
      return found->second;
    };
    for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
      const std::uint32_t a = mesh.indices[n], b = mesh.indices[n + 1], c = mesh.indices[n + 2];
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.indices.insert(finer.indices.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
    }
    mesh = std::move(finer);
  }
  for (Vec3& p : mesh.positions) p = centre + radius * p;
  return mesh;
}

/// Box of half edges h, turned and moved.
inline SurfaceMesh box_mesh(const Vec3& h, const Pose& pose = {}) {
  SurfaceMesh mesh;
  for (const Vec3& corner : Bounds{-h, h}.corners()) mesh.positions.push_back(pose * corner);
  mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  return mesh;
}

inline SurfaceMesh inside_out(SurfaceMesh mesh) {
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) std::swap(mesh.indices[n + 1], mesh.indices[n + 2]);
  return mesh;
}

inline SurfaceMesh joined(SurfaceMesh a, const SurfaceMesh& b) {
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const std::uint32_t i : b.indices) a.indices.push_back(first + i);
  return a;
}

/// Sum of solid angles over 4 pi [VanOosterom83]: 1 inside, 0 outside of a closed mesh; shares nothing with the slices.
inline double winding_number(const SurfaceMesh& mesh, const Vec3& p) {
  double sum = 0.0;
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    const Vec3 a = mesh.positions[mesh.indices[n]] - p, b = mesh.positions[mesh.indices[n + 1]] - p,
               c = mesh.positions[mesh.indices[n + 2]] - p;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    sum += 2.0 * std::atan2(glm::dot(a, glm::cross(b, c)), la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  return sum / (4.0 * std::numbers::pi);
}

enum class MeshForm { stl_binary, stl_text, obj, ply };

inline std::string stl_bytes(const SurfaceMesh& mesh, double unit) {
  std::string bytes(84, ' ');
  const auto count = static_cast<std::uint32_t>(mesh.indices.size() / 3);
  std::memcpy(bytes.data() + 80, &count, 4);
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    float numbers[12] = {};
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t x = 0; x < 3; ++x) numbers[3 + 3 * c + x] = static_cast<float>(mesh.positions[mesh.indices[n + c]][x] / unit);
    bytes.append(reinterpret_cast<const char*>(numbers), sizeof numbers).append(2, '\0');
  }
  return bytes;
}

inline std::string text_of(const Vec3& p, double unit) {
  char text[96];
  std::snprintf(text, sizeof text, "%.9g %.9g %.9g", p.x / unit, p.y / unit, p.z / unit);
  return text;
}

inline std::string mesh_bytes(const SurfaceMesh& mesh, MeshForm form, double unit) {
  if (form == MeshForm::stl_binary) return stl_bytes(mesh, unit);
  std::string text;
  const auto corner = [&](std::size_t n) { return std::to_string(mesh.indices[n] + (form == MeshForm::obj ? 1 : 0)); };
  if (form == MeshForm::stl_text) {
    text = "solid made by a test\n";
    for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
      text += "facet normal 0 0 0\nouter loop\n";
      for (std::size_t c = 0; c < 3; ++c) text += "vertex " + text_of(mesh.positions[mesh.indices[n + c]], unit) + "\n";
      text += "endloop\nendfacet\n";
    }
    return text + "endsolid\n";
  }
  if (form == MeshForm::ply)
    text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(mesh.positions.size()) +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(mesh.indices.size() / 3) +
           "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Vec3& p : mesh.positions) text += (form == MeshForm::obj ? "v " : "") + text_of(p, unit) + "\n";
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3)
    text += (form == MeshForm::obj ? "f " : "3 ") + corner(n) + " " + corner(n + 1) + " " + corner(n + 2) + "\n";
  return text;
}

inline const char* ending_of(MeshForm form) { return form == MeshForm::obj ? ".obj" : form == MeshForm::ply ? ".ply" : ".stl"; }

inline void write_file(const std::string& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

/// Writes `mesh` (in m) with lengths in `unit` [m]. @returns the path.
inline std::string write_mesh(const std::string& path_without_ending, const SurfaceMesh& mesh, MeshForm form, double unit = 1e-3) {
  const std::string path = path_without_ending + ending_of(form);
  write_file(path, mesh_bytes(mesh, form, unit));
  return path;
}

}  // namespace burrhole::test
