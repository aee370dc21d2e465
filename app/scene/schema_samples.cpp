#include "app/scene/schema_samples.h"

#include <array>

#include "app/scene/scene.h"
#include "app/scene/volume_scene.h"
#include "core/tool/mesh_spec.h"
#include "core/tool/tool_spec.h"
#include "volumes/read/raw_sidecar.h"

namespace burrhole {
namespace {

/// Tables that every sample has, so that no condition refers to them.
constexpr std::array<const char*, 4> kBaseEffects{"contact", "erosion", "display", "record"};

/// @returns a scene with the base effects. @param lines of table `table`, which is added if it is not a base effect.
std::string scene(const std::string& volume, const std::string& table = {}, const std::string& lines = {}) {
  std::string out =
      "[volume]\n" + volume + "\n[tool]\nname = \"perforator_14_11\"\nspin_rpm = 1000\n[approach]\nentry_mm = [0, 0, 0]\n[hand]\n";
  if (table == "hand") out += lines + "\n";
  bool placed = table.empty() || table == "hand";
  for (const char* effect : kBaseEffects) {
    out += std::string("[") + effect + "]\n";
    if (table == effect) out += lines + "\n";
    placed = placed || table == effect;
  }
  return placed ? out : out + "[" + table + "]\n" + lines + "\n";
}

std::vector<SchemaSample> scene_samples() {
  const std::string plate = "source = \"phantom:plate\"";
  std::vector<SchemaSample> samples;
  for (const std::string& kind : phantom_names()) samples.push_back({"phantom:" + kind, scene("source = \"phantom:" + kind + "\""), {}});
  const std::string head = "source = \"phantom:head\"", entry = "entry_mm = [0, 0, 0]";
  for (const std::string shape : {"square", "round"})
    samples.push_back({"phantom:head drape " + shape, scene(head, "display", "drape = \"" + shape + "\""), {}});
  samples.push_back({"skin = true", scene(head, "display", "skin = true"), {}});
  std::string at_site = scene(head);
  at_site.replace(at_site.find(entry), entry.size(), "site = \"kocher_left\"");
  samples.push_back({"site", at_site, {}});
  std::string planned = scene(plate);
  planned.replace(planned.find(entry), entry.size(), "markups = \"PLAN.mrk.json\"");
  samples.push_back({"markups", planned, "cannot be read"});
  // The reference shows names in capitals unchanged.
  for (const std::string& unit : length_unit_names())
    samples.push_back({"scan in " + unit, scene("source = \"SCAN\"\nunit = \"" + unit + "\"\n[[volume.hardness]]\nvalue = 0\nhardness = 0"),
                       "is not there"});
  samples.push_back({"scan layers", scene("source = \"SCAN\"\nlayers = \"segment\""), "is not there"});
  for (const std::string scheme : {"planes", "gradient", "hold", "linear"})
    samples.push_back({"servo " + scheme, scene(plate, "servo", "multirate = \"" + scheme + "\""), {}});
  for (const std::string push : {"", "\npush_N = 20"})
    samples.push_back({"feed", scene(plate, "hand", "kind = \"feed\"\nstop_mm = 3" + push), {}});
  samples.push_back({"mouse", scene(plate, "hand", "kind = \"mouse\""), {}});
  samples.push_back({"limits", scene(plate, "limits", "memory_mb = 1000"), {}});
  samples.push_back({"output", scene(plate, "output"), {}});
  samples.push_back({"outcome", scene(plate, "outcome"), {}});
  for (const EffectEntry& effect : shipped_effects()) {
    samples.push_back({effect.table, scene(plate, effect.table), {}});
    for (const std::string& lines : effect.samples)
      samples.push_back(
          {std::string("[") + effect.table + "] " + lines.substr(0, lines.find('\n')), scene(plate, effect.table, lines), {}});
  }
  return samples;
}

std::string tool(const std::string& shape, const std::string& size) {
  return "title = \"a tool\"\n[shell]\npitch_mm = 0.5\n[[region]]\nshape = \"" + shape + "\"\nz_mm = 0\nerosion_factor = 0.1\n" + size +
         "\n";
}

std::vector<SchemaSample> tool_samples() {
  const std::string round = "diameter_mm = 4\nheight_mm = 3";
  return {
      {"cylinder", tool("cylinder", round), {}},
      {"cone", tool("cone", round), {}},
      {"frustum", tool("frustum", "bottom_diameter_mm = 4\ntop_diameter_mm = 3\nheight_mm = 3"), {}},
      {"sphere", tool("sphere", "diameter_mm = 4"), {}},
      {"ellipsoid", tool("ellipsoid", round), {}},
      {"shape = tube and one diameter", tool("tube", round + "\ninner_diameter_mm = 2"), {}},
      {"shape = tube and a diameter at each end",
       tool("tube", "height_mm = 3\nbottom_diameter_mm = 4\ntop_diameter_mm = 3\ninner_bottom_diameter_mm = 2\ninner_top_diameter_mm = 2"),
       {}},
      {"box", tool("box", "height_mm = 3\nwidth_mm = 4\ndepth_mm = 1"), {}},
      {"mesh", "title = \"a tool\"\n[mesh]\nfile = \"FILE.stl\"\nerosion_factor = 0.1\npitch_mm = 0.5\n", {}},
  };
}

std::vector<SchemaSample> raw_samples() {
  const auto raw = [](const std::string& files, const std::string& type, const std::string& order) {
    return files + "\ndims = [2, 2, 2]\nspacing_mm = [1, 1, 1]\ntype = \"" + type + "\"\nbyte_order = \"" + order + "\"\n";
  };
  std::vector<SchemaSample> samples{{"a file a slice", raw("files = \"FILE.*\"", "int16", "big"), {}},
                                    {"in HU", raw("data = \"FILE\"\nquantity = \"hounsfield\"", "int16", "big"), {}}};
  for (const std::string& type : raw_type_names()) samples.push_back({type, raw("data = \"FILE\"", type, "little"), {}});
  return samples;
}

constexpr const char* kSceneExample = R"(title = "Parietal burrhole"
duration_s = 90.0               # of simulated time, at most

[volume]                        # generated bone: tables, porous diploe, dura and brain
source = "phantom:skull_patch"
spacing_mm = 0.25
thickness_mm = 7.04

[tool]
name = "perforator_14_11"       # `burrhole tools` lists them
spin_rpm = 1000.0

[approach]                      # bone frame; z points out of the skull
entry_mm = [0.0, 0.0, 0.0]
axis = [0.0, 0.0, -1.0]         # direction of drilling

[hand]
push_N = 28.0

[contact]                       # each table from here on enables an effect
[erosion]
[display]
size = [1200, 900]
[record]
)";

constexpr const char* kToolExample = R"(title = "Stepped drill, 10/6 mm"

[shell]
pitch_mm = 0.4                  # largest distance between contact points

[[region]]
name = "pilot"                  # the tip; its lower end is the origin
shape = "frustum"
z_mm = 0
height_mm = 3
bottom_diameter_mm = 6
top_diameter_mm = 5.8           # relieved: only the leading edge touches the wall
erosion_factor = 0.05
rim_factor = 1.5                # cuts faster at the rim than on the axis

[[region]]
name = "shank"
shape = "cylinder"
z_mm = 3
height_mm = 20
diameter_mm = 10
erosion_factor = 0              # does not cut
pitch_mm = 1.0
)";

constexpr const char* kRawExample = R"(folder = "$BURRHOLE_DATA/head_ct_raw_big_endian"
files = "CThead.*"                  # one file a slice
dims = [256, 256, 113]
type = "int16"
byte_order = "big"
spacing_mm = [0.9375, 0.9375, 1.875]
direction = [1, 0, 0, 0, 1, 0, 0, 0, -1]   # the first slice is the vertex
assumed = "spacing: only its ratio is published"
)";

}  // namespace

std::vector<SchemaSample> schema_samples(SchemaFile file) {
  switch (file) {
    case SchemaFile::scene:
      return scene_samples();
    case SchemaFile::tool:
      return tool_samples();
    case SchemaFile::raw:
      return raw_samples();
  }
  return {};
}

std::string schema_example(SchemaFile file) {
  return file == SchemaFile::scene ? kSceneExample : file == SchemaFile::tool ? kToolExample : kRawExample;
}

ReadSample read_sample(SchemaFile file, const std::string& text) {
  ReadSample out;
  const auto document = TomlDocument::parse(text, "sample.toml");
  if (!document)
    out.issues.push_back(document.error());
  else if (file == SchemaFile::scene)
    (void)read_scene(*document, {.tool_folders = {}, .tool_given = true}, out.issues, &out.log);
  else if (file == SchemaFile::tool && has_tool_mesh(*document))
    (void)read_mesh_tool_spec(*document, out.issues, &out.log);
  else if (file == SchemaFile::tool)
    (void)read_tool_spec(*document, out.issues, &out.log);
  else if (const auto sidecar = parse_raw_sidecar(*document, &out.log); !sidecar)
    out.issues.push_back(sidecar.error());
  return out;
}

}  // namespace burrhole
