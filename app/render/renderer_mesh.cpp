// The bone as triangles: what a Renderer does in place of rays.
#include "app/render/renderer_impl.h"

namespace burrhole {

Status Renderer::Impl::set_mesh(const VolumeView& view) {
  auto made = BoneMesh::create(view, {.labels = options.appearance.labels, .find_cuts = options.textures != nullptr});
  if (!made) return made.error();
  std::optional<BonePaint> painted;
  if (options.textures) {
    auto of_bone = BonePaint::create(gl, *options.textures, made->loaded_box());
    if (!of_bone) return of_bone.error();
    painted = std::move(of_bone).value();
  }
  std::optional<SkinMesh> shell;
  if (view.skin) {
    auto of_skin = SkinMesh::create(gl, *view.skin);
    if (!of_skin) return of_skin.error();
    shell = std::move(of_skin).value();
  }
  skin = std::move(shell);
  mesh = std::move(made).value();
  mesh_buffer.emplace(gl);
  paint = std::move(painted);
  counters.texture_bytes = paint ? paint->bytes() : 0;
  section_colors.reset();
  cache.forget();
  counters.volume_bytes = 0;
  return {};
}

Status Renderer::Impl::send_mesh(bool cut) {
  if (!mesh) return {};
  const auto sent = mesh_buffer->send(*mesh);
  if (!sent) return sent.error();
  counters.mesh_bytes += sent->whole;
  counters.mesh_update_bytes += sent->changed;
  if (!cut || section_colors) return {};
  auto made = make_color_texture(gl, mesh->dims(), mesh->colors());
  if (!made) return made.error();
  section_colors = std::move(made).value();
  counters.volume_bytes = mesh->colors().size() * sizeof(Rgba8);
  return {};
}

std::string Renderer::Impl::shader_names(bool cut) const {
  if (mesh) return bone_mesh_variant(cut, false).name;
  if (!volume) return {};
  std::string out = volume_variant(cut, false, has_soft(), outer_level()).name;
  if (has_surface()) out += " " + light_variant(cut, has_tissue(), has_soft(), outer_level()).name;
  return out;
}

ShaderVariant Renderer::Impl::bone_mesh_variant(bool cut, bool probe) const {
  const BoneTextures* textures = options.textures.get();
  return mesh_variant({.cut = cut,
                       .probe = probe,
                       .finish = options.finish,
                       .specular = options.appearance.specular,
                       .fog = has_fog,
                       .exterior = textures != nullptr && !textures->exterior.pixels.empty(),
                       .interior = textures != nullptr && !textures->interior.pixels.empty()});
}

Result<Renderer::Impl::Programs> Renderer::Impl::find_mesh_programs(bool cut, ToolPass pass) {
  Programs out;
  const auto find = [this](const ShaderVariant& variant, GLuint& program) -> Status {
    const auto found = programs.find_or_link(variant);
    if (!found) return found.error();
    program = found.value();
    return {};
  };
  if (Status found = find(background_variant(has_table, has_fog), out.background); !found) return found.error();
  if (Status found = find(bone_mesh_variant(cut, pass == ToolPass::probe), out.volume); !found) return found.error();
  if (Status found = find(tool_variant(pass, has_fog), out.tool); !found) return found.error();
  if (skin)
    if (Status found = find_skin_programs(cut, out); !found) return found.error();
  return out;
}

/// The background has no hit, so only its picture is written.
void Renderer::Impl::draw_mesh(const PixelRect& part, const FrameBlock& block, GLuint background, GLuint program) {
  target.bind_for_light();
  draw_screen(background);
  target.bind();
  gl.UseProgram(program);
  if (section_colors) gl.BindTextureUnit(1, section_colors->name());
  if (paint) paint->bind();
  const glm::dmat4 place(block.world_from_bone_at);
  mesh_buffer->draw(rays_of(block), {Mat3(place), Vec3(place[3])}, part, {static_cast<int>(block.lens.z), static_cast<int>(block.lens.w)});
}

}  // namespace burrhole
