#include "app/engine/load.h"

#include <fstream>
#include <sstream>

#include "core/tool/make_tool.h"
#include "volumes/phantom/phantom.h"

namespace burrhole {
namespace {

std::shared_ptr<const BoneModel> load_bone(const VolumeScene& volume, const std::string& place, Issues& issues) {
  const auto refuse = [&](Error error) {
    if (error.place.empty()) error.place = place;
    issues.push_back(std::move(error));
    return nullptr;
  };
  if (!volume.phantom) {
    auto bone = BoneModel::load(volume.vdb_path);
    return bone ? std::move(bone).value() : refuse(bone.error());
  }
  auto phantom = make_phantom(*volume.phantom);
  if (!phantom) return refuse(phantom.error());
  auto bone = BoneModel::create(phantom->bone);
  return bone ? std::move(bone).value() : refuse(bone.error());
}

}  // namespace

std::optional<LoadedScene> load_scene(const TomlDocument& document, const SceneContext& context, Issues& issues,
                                      const std::optional<std::string>& tool_text) {
  SceneContext own_context = context;
  own_context.tool_given = tool_text.has_value();
  auto scene = read_scene(document, own_context, issues);
  if (!scene) return std::nullopt;
  LoadedScene out;
  out.scene = std::move(*scene);

  if (tool_text) {
    out.tool_text = *tool_text;
  } else {
    std::ifstream file(out.scene.tool.path);
    std::ostringstream text;
    text << file.rdbuf();
    out.tool_text = text.str();
  }
  out.bone = load_bone(out.scene.volume, document.file_name(), issues);
  if (!out.bone) return std::nullopt;
  auto tool_document = TomlDocument::parse(out.tool_text, tool_text ? "the session's tool" : out.scene.tool.path);
  if (!tool_document) {
    issues.push_back(tool_document.error());
    return std::nullopt;
  }
  const double pitch = out.scene.tool.erosion_pitch_voxels * out.bone->bone_from_index().mean_edge();
  auto tool = make_tool(*tool_document, {pitch}, issues);
  if (!tool) return std::nullopt;
  out.tool = std::move(*tool);
  for (float& factor : out.tool.erosion.factors) factor *= static_cast<float>(out.scene.tool.erosion_scale);
  return out;
}

}  // namespace burrhole
