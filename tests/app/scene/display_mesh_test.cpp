// The keys of [display] for method = "mesh": which are accepted, what they give, and each refusal in one line. The memory of a mesh.
#include <doctest/doctest.h>

#include <fstream>

#include "app/scene/memory_plan.h"
#include "app/view/display_config.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

std::string mesh_scene(const std::string& keys) { return scene_text({.display = true}) + "method = \"mesh\"\n" + keys; }

DisplayConfig display_of(const std::string& keys) {
  LoadedScene loaded = load_text(mesh_scene(keys), {});
  return *loaded.scene.find<DisplayConfig>();
}

std::string refusal(const std::string& text) {
  const auto document = TomlDocument::parse(text, "mesh.toml");
  REQUIRE(document.ok());
  Issues issues;
  const auto loaded = load_scene(*document, test_context(), issues);
  REQUIRE(!loaded);
  REQUIRE(issues.size() == 1);
  CHECK(issues.front().text().find('\n') == std::string::npos);
  CHECK_MESSAGE(issues.front().text().starts_with("mesh.toml:"), issues.front().text());
  return issues.front().text();
}

void refuses(const std::string& keys, const std::string& words) {
  const std::string line = refusal(mesh_scene(keys));
  CHECK_MESSAGE(line.find(words) != std::string::npos, line);
}

TEST_CASE("display mesh: textures are drawn where they are named, at the scale of their pattern, unless another colour is asked for") {
  const DisplayConfig none = display_of("");
  CHECK(!draws_textures(none));
  CHECK(none.appearance.labels);
  const DisplayConfig bone = display_of("exterior_texture = \"bone\"\ninterior_texture = \"bone\"\n");
  CHECK(draws_textures(bone));
  CHECK(bone.textures.exterior == "bone");
  CHECK(bone.textures.exterior_edge == doctest::Approx(0.020));
  REQUIRE(bone.textures.interior_edge);
  CHECK(*bone.textures.interior_edge == doctest::Approx(0.012));
  CHECK(bone.textures.axis == 2);
  const DisplayConfig apple = display_of("interior_texture = \"apple\"\ntexture_axis = \"x\"\n");
  CHECK(draws_textures(apple));
  CHECK(apple.textures.exterior.empty());
  CHECK(!apple.textures.interior_edge);
  CHECK(apple.textures.axis == 0);
  const DisplayConfig scaled = display_of("exterior_texture = \"apple\"\nexterior_mm = 7\ninterior_texture = \"apple\"\ninterior_mm = 9\n");
  CHECK(scaled.textures.exterior_edge == doctest::Approx(0.007));
  CHECK(*scaled.textures.interior_edge == doctest::Approx(0.009));
  for (const char* colour : {"voxel", "plain"}) {
    const DisplayConfig other = display_of(std::string("exterior_texture = \"bone\"\ncolour = \"") + colour + "\"\n");
    CHECK(!draws_textures(other));
    CHECK(other.appearance.labels == (colour == std::string("voxel")));
  }
  CHECK(!display_of("label_colours = false\n").appearance.labels);
}

TEST_CASE("display mesh: what is no texture is refused at its key, with the next step") {
  const TemporaryFolder folder;
  std::ofstream(folder.file("text.png")) << "no image";
  refuses("exterior_texture = \"appel\"\n", "did you mean \"apple\"?");
  refuses("exterior_texture = \"stone\"\n", "must be \"bone\", \"apple\", \"cucumber\", or the path of a PNG file");
  refuses("interior_texture = \"none/such.png\"\n", "is not there: tried none/such.png");
  refuses("exterior_texture = \"" + folder.file("text.png") + "\"\n", "is not a PNG image: convert it to PNG");
  refuses("exterior_texture = \"" + folder.path().string() + "\"\n", "is a folder: give a file");
  refuses("interior_texture = \"/dev/null\"\n", "is a device: give a regular file");
  refuses("colour = \"texture\"\n", "needs exterior_texture or interior_texture");
  refuses("colour = \"plain\"\nlabel_colours = false\n", "is given by colour: remove one of the two");
  refuses("exterior_mm = 0\n", "display.exterior_mm");
  refuses("texture_axis = \"w\"\n", "texture_axis");
  const std::string of_rays = refusal(scene_text({.display = true}) + "exterior_texture = \"bone\"\n");
  CHECK_MESSAGE(of_rays.find("exterior_texture") != std::string::npos, of_rays);
}

TEST_CASE("display mesh: skin is accepted over a mesh of a whole head, as over rays") {
  const std::string head = scene_text({.volume = "source = \"phantom:head\"\nspacing_mm = 1\nsurroundings_mm = 3\n", .display = true});
  const LoadedScene loaded = load_text(head + "skin = true\nmethod = \"mesh\"\n", {});
  CHECK(loaded.scene.find<DisplayConfig>()->skin.has_value());
}

TEST_CASE("display mesh: the plan counts the mesh and its textures, and the limit refuses what exceeds it") {
  const auto bytes_of = [](const std::string& keys) {
    const LoadedScene loaded = load_text(mesh_scene(keys), {});
    const MemoryPlan plan = plan_memory(loaded.scene, loaded.tool, shape_of(*loaded.bone, loaded.scene.approach), 0);
    for (const MemoryItem& item : plan.items)
      if (item.name == "display") return item.bytes;
    return std::uint64_t{0};
  };
  const LoadedScene loaded = load_text(mesh_scene(""), {});
  const std::uint64_t voxels = loaded.bone->bounds().count();
  // 96^3 texels of a volume, twice and a seventh, and a byte for each voxel.
  constexpr std::uint64_t kVolume = std::uint64_t{4} * 96 * 96 * 96;
  CHECK(bytes_of("interior_texture = \"bone\"\n") == bytes_of("") + 2 * kVolume + kVolume / 7 + voxels);
  CHECK(bytes_of("interior_texture = \"bone\"\ncolour = \"voxel\"\n") == bytes_of(""));
  const std::string line = refusal(mesh_scene("interior_texture = \"bone\"\n") + "[limits]\nmemory_mb = 60\n");
  CHECK_MESSAGE(line.find("limits.memory_mb is exceeded") != std::string::npos, line);
}

}  // namespace
}  // namespace burrhole::test
