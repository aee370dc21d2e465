#include "volumes/export_bone.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/base/descriptor.h"
#include "core/base/output_file.h"
#include "core/voxel/vdb_grids.h"
#include "volumes/read/number_text.h"
#include "volumes/write/ball_surface.h"
#include "volumes/write/bone_surface.h"
#include "volumes/write/image_writer.h"
#include "volumes/write/mesh_writer.h"

namespace burrhole {
namespace {

constexpr int kCropMargin = 4;  ///< [voxels] round the bone: more than a ramp of occupancy is wide

struct Ending {
  const char *text, *format;
};
constexpr Ending kEndings[] = {{".nrrd", "NRRD"}, {".nii", "NIfTI-1"}, {".nii.gz", "NIfTI-1"}, {".vdb", "OpenVDB"},
                               {".stl", "STL"},   {".ply", "PLY"},     {".obj", "OBJ"}};

bool is_volume(const std::string& format) { return format == "NRRD" || format == "NIfTI-1"; }

std::vector<VoxelBox> regions_of(const BoneModel& bone) {
  std::vector<VoxelBox> out;
  bone.for_each_region([&](const VoxelBox& box) { out.push_back(box); });
  return out;
}

VoxelBox box_of(const BoneModel& bone, bool crop) {
  return crop ? bone.bone_box().grown(kCropMargin).intersect(bone.bounds()) : bone.bounds();
}

Result<ExportReport> export_image(const Voxmap& bone, const ExportRequest& request, const std::string& format) {
  const BoneModel& model = bone.bone();
  const ExportField field = request.field.value_or(ExportField::density);
  const ImageOut image{.box = box_of(model, request.crop),
                       .bone_from_index = model.bone_from_index(),
                       .labels = field == ExportField::labels,
                       .content = export_field_names()[static_cast<std::size_t>(field)],
                       .read = [&](const VoxelBox& box, std::span<float> out) { read_field(bone, field, request.undrilled, box, out); },
                       .progress = request.progress,
                       .check = [&] { return model.read_status(); },
                       .stop = request.stop};
  if (image.box.empty()) return bad_input("there is no bone to crop to", request.path);
  if (request.begin) request.begin();
  const auto bytes =
      format == "NRRD" ? write_nrrd(request.path, image) : write_nifti(request.path, image, lower(request.path).ends_with(".gz"));
  if (!bytes) return bytes.error();
  return ExportReport{.format = format, .dims = image.box.size(), .bytes = *bytes};
}

Result<ExportReport> export_mesh(const Voxmap& bone, const ExportRequest& request, const std::string& format) {
  const DensitySource density{
      .regions = regions_of(bone.bone()),
      .bone_from_index = bone.bone().bone_from_index(),
      .read = [&](const VoxelBox& box, std::span<float> out) { read_field(bone, ExportField::density, request.undrilled, box, out); }};
  const auto mesh = request.ball ? make_ball_surface(density) : make_bone_surface(density);
  if (!mesh) return Error{mesh.error().code, mesh.error().message, request.path};
  if (const Status read = bone.bone().read_status(); !read) return read.error();
  if (request.begin) request.begin();
  const auto bytes = write_mesh(request.path, format, *mesh, request.stop);
  if (!bytes) return bytes.error();
  return ExportReport{.format = format, .triangles = mesh->indices.size() / 3, .bytes = *bytes};
}

/// A bone model of this program, with one grid more for others.
Result<ExportReport> export_vdb(const Voxmap& bone, const ExportRequest& request) {
  const BoneModel& model = bone.bone();
  std::vector<const FloatVdb*> grids = model.grids();
  if (grids.empty())
    return bad_input("a bone whose voxels are in a temporary file cannot be saved whole: export it as .nrrd or .nii", request.path);
  FloatVdb density("density", 0.0f), remaining("remaining", 1.0f);
  std::vector<float> values;
  for (const VoxelBox& region : regions_of(model)) {
    values.resize(region.count());
    read_field(bone, ExportField::density, request.undrilled, region, values);
    density.write_box(region, values);
  }
  grids.insert(grids.begin(), &density);
  if (!request.undrilled) {
    bone.blocks().for_each_block(
        [&](const Vec3i& block, const BlockValues& block_values) { remaining.write_box(box_of_block(block), block_values); });
    grids.push_back(&remaining);
  }
  if (request.begin) request.begin();
  const Status written = write_vdb(request.path, model.dims(), model.bone_from_index(), grids, model.notes(), request.stop);
  if (!written) return written.error();
  std::error_code ignored;
  return ExportReport{.format = "OpenVDB", .dims = model.dims(), .bytes = std::filesystem::file_size(request.path, ignored)};
}

}  // namespace

const std::vector<std::string>& export_field_names() {
  static const std::vector<std::string> names{"density", "hardness", "remaining", "labels"};
  return names;
}

Result<std::string> export_format(const std::string& path) {
  const std::string name = lower(path);
  for (const Ending& ending : kEndings)
    if (name.ends_with(ending.text)) return std::string(ending.format);
  return bad_input("must end in .nrrd, .nii, .nii.gz, .vdb, .stl, .ply or .obj; a planned line in .mrk.json or .fcsv", path);
}

Status check_request(const ExportRequest& request) {
  const auto format = export_format(request.path);
  if (!format) return format.error();
  if (is_volume(*format)) {
    if (request.undrilled && request.field == ExportField::remaining)
      return bad_input("the field remaining of bone as loaded is 1 everywhere: choose another field, or export it as it is now",
                       request.path);
    return {};
  }
  if (request.field)
    return bad_input(
        *format == "OpenVDB" ? "a .vdb holds all fields: leave the field out" : "a mesh is the surface of the density: leave the field out",
        request.path);
  if (request.crop) return bad_input("only .nrrd and .nii are cropped: a .vdb and a mesh hold no empty space", request.path);
  return {};
}

void read_field(const Voxmap& bone, ExportField field, bool undrilled, const VoxelBox& box, std::span<float> out) {
  const BoneModel& model = bone.bone();
  switch (field) {
    case ExportField::density:
      return undrilled ? model.read_occupancy(box, out) : bone.read_density(box, out);
    case ExportField::hardness:
      return model.read_hardness(box, out);
    case ExportField::remaining:
      return bone.read_remaining(box, out);
    case ExportField::labels:
      break;
  }
  model.read_labels(box, out);
  if (undrilled) return;
  std::vector<float> remaining(box.count()), density(box.count());
  bone.read_remaining(box, remaining);
  bone.read_density(box, density);
  for (std::size_t n = 0; n < out.size(); ++n)
    if (remaining[n] < 1.0f && density[n] < 0.5f && is_felt(static_cast<VoxelLabel>(static_cast<int>(out[n])))) out[n] = 0.0f;
}

Result<ExportReport> export_bone(const Voxmap& bone, const ExportRequest& request) {
  if (const Status valid = check_request(request); !valid) return valid.error();
  if (is_stopped(request.stop)) return stopped_error(request.path);
  const std::string format = export_format(request.path).value();
  // Images and meshes check before they rename their file that all of the bone was read: a read that failed is taken for 0. A .vdb is written
  // only of a bone in memory, which no read can fail to get.
  if (is_volume(format)) return export_image(bone, request, format);
  return format == "OpenVDB" ? export_vdb(bone, request) : export_mesh(bone, request, format);
}

}  // namespace burrhole
