// The model `surface`: its keys, and the constrained tool made from them.

#include <limits>

#include "core/config/rules.h"
#include "core/contact/contact_form.h"
#include "core/contact/surface_contact.h"

namespace burrhole {
namespace {

/// [-] Factor of diploe that was found in a scan. The scan's hardness is linear in density, and its voxels mix trabeculae with the tables: the
/// cadaver's diploe of 900 HU has a hardness of 0.63. An assumption: with it, diploe is about as stiff as that of the phantoms.
constexpr float kScannedDiploe = 0.3f;

LabelFactors read_label_stiffness(TableReader table) {
  LabelFactors out = kAllAlike;
  const auto read = [&](VoxelLabel label, std::string_view key, std::string_view about) {
    auto& factor = out[static_cast<std::size_t>(label)];
    factor = static_cast<float>(table.number(key, {.fallback = static_cast<double>(factor), .min = 0.01, .max = 1.0}, about));
  };
  read(VoxelLabel::bone, "bone", "bone whose layers are not distinguished: scans and simple phantoms");
  read(VoxelLabel::outer_table, "outer_table", "outer table of the skull");
  read(VoxelLabel::diploe, "diploe",
       "diploe between the tables; without this key 0.3 where the layers are those of a scan (layers = \"segment\"), an assumption");
  read(VoxelLabel::inner_table, "inner_table", "inner table of the skull");
  read(VoxelLabel::forbidden, "forbidden", "bone marked as not to be cut");
  table.finish();
  return out;
}

class SurfaceForm final : public ContactForm {
 public:
  explicit SurfaceForm(TableReader& table) {
    tool_.coupling_stiffness =
        table.number("coupling_N_per_m", above_zero(tool_.coupling_stiffness, 1.0, 1e6), "stiffness of the spring from hand to tool");
    tool_.coupling_damping =
        table.number("coupling_N_s_per_m", at_least_zero(tool_.coupling_damping, 1.0, 1e4), "coefficient of the damper from hand to tool");
    const bool locked =
        table.choice("turning", "free", {"free", "locked"},
                     "free: bone may turn the tool against a rotational spring; locked: the tool has the orientation of the hand") ==
        "locked";
    if (locked)
      tool_.turn_stiffness = std::numeric_limits<double>::infinity();
    else
      tool_.turn_stiffness = table.number("coupling_Nm_per_rad", above_zero(tool_.turn_stiffness, 1.0, 1e6),
                                          "stiffness of the rotational spring; its damping over its stiffness is that of the other spring");
    tool_.cutting_stiffness = table.number("cutting_N_per_m", above_zero(tool_.cutting_stiffness, 1.0, 1e9),
                                           "cutting stiffness: force on the cutting points of a spinning tool over its engagement");
    tool_.bone_stiffness = table.number("bone_N_per_m", above_zero(tool_.bone_stiffness, 1.0, 1e12),
                                        "stiffness of bone of hardness 1 under one contact that does not cut; in proportion to the "
                                        "hardness, with a hardness of at least 0.1");
    if (auto labels = table.table("label_stiffness", "factors on bone_N_per_m by tissue, for layers that are softer than their hardness")) {
      diploe_given_ = labels->has("diploe");
      label_stiffness_ = read_label_stiffness(*labels);
    }
    tool_.felt_hardness =
        table.number("felt_hardness", {.fallback = tool_.felt_hardness, .min = 0.0, .max = 0.9},
                     "share by which the spring from hand to tool is softer on bone of hardness 0, in proportion to the hardness "
                     "times its factor of label_stiffness: a hand then feels tables and diploe; 0: the same spring everywhere");
    if (table.choice("record_bits", "16", {"8", "16"},
                     "bits of each number of a surface record: 8 needs less memory, 16 is more accurate") == "8")
      record_bits_ = RecordPrecision::bits8;
  }

  std::unique_ptr<ContactForm> clone() const override { return std::make_unique<SurfaceForm>(*this); }
  void* config(std::type_index type) noexcept override {
    if (type == typeid(ConstrainedToolConfig)) return &tool_;
    return type == typeid(RecordPrecision) ? &record_bits_ : nullptr;
  }
  void take_scan_layers() noexcept override {
    if (!diploe_given_ && tool_.felt_hardness > 0.0) label_stiffness_[static_cast<std::size_t>(VoxelLabel::diploe)] = kScannedDiploe;
  }
  ContactFormNeeds needs() const override {
    ContactFormNeeds out;
    out.fields.records = record_bits_;
    out.fields.label_stiffness = label_stiffness_;
    out.holds_back = true;
    out.coupling_stiffness = tool_.coupling_stiffness;
    out.coupling_damping = tool_.coupling_damping;
    out.cutting_stiffness = tool_.cutting_stiffness;
    out.felt_hardness = tool_.felt_hardness;
    return out;
  }
  std::string text() const override {
    return std::string("surface, ") + (record_bits_ == RecordPrecision::bits8 ? "8" : "16") + "-bit records, tool held back by bone";
  }
  Result<std::unique_ptr<ContactModel>> make(const PointShell& shell, const ContactOptions& options) const override {
    return make_surface_contact(tool_, shell, options);
  }

 private:
  ConstrainedToolConfig tool_;
  RecordPrecision record_bits_ = RecordPrecision::bits16;
  LabelFactors label_stiffness_ = kAllAlike;
  bool diploe_given_ = false;
};

}  // namespace

std::unique_ptr<ContactForm> read_surface_form(TableReader& table) { return std::make_unique<SurfaceForm>(table); }

}  // namespace burrhole
