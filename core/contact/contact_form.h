/// core/contact/contact_form.h: a contact model as declared in a scene: its keys, the fields of bone that it reads, and its construction.
///   Each model has its form in one file; app/effect/contact.cpp has the table of all forms.
///   Units SI.   Thread: while no clock runs.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <typeindex>

#include "core/base/result.h"
#include "core/config/toml.h"
#include "core/contact/contact_model.h"
#include "core/voxel/contact_window.h"

namespace burrhole {

/// The requirements of a model on the stage.
struct ContactFormNeeds {
  ContactFields fields{.density = true, .gradient = false, .words = false, .records = {}};  ///< of the window's copies
  bool paper_grids = false;                                                                 ///< also provide the sparse grids of the paper
  bool any_density = false;                                      ///< true: bone of any density above 0 collides; false: from 0.5 on
  bool holds_back = false;                                       ///< true: bone constrains a tool with its own pose; false: a penalty model
  double coupling_stiffness = 0.0;                               ///< [N/m] hand to tool, of a constrained tool
  double coupling_damping = 0.0;                                 ///< [N s/m] hand to tool, of a constrained tool
  double felt_hardness = 0.0;                                    ///< [-] share by which that coupling is softer on bone of hardness 0
  double cutting_stiffness = 0.0;                                ///< [N/m] thrust over engaged depth, of a constrained tool
  double plane_reach = std::numeric_limits<double>::infinity();  ///< [voxels] largest distance from its pose at which a plane is valid
};

class ContactForm {
 public:
  virtual ~ContactForm() = default;
  [[nodiscard]] virtual std::unique_ptr<ContactForm> clone() const = 0;
  /// The config struct of a type; null when the form has none of that type.
  [[nodiscard]] virtual void* config(std::type_index type) noexcept = 0;
  [[nodiscard]] virtual ContactFormNeeds needs() const = 0;
  /// The layers of the bone were found in a scan: a factor of a layer that the scene does not give takes its default for scans.
  virtual void take_scan_layers() noexcept {}
  /// A short text for `burrhole explain`.
  [[nodiscard]] virtual std::string text() const = 0;
  /// Errors: those of the model's create().
  [[nodiscard]] virtual Result<std::unique_ptr<ContactModel>> make(const PointShell& shell, const ContactOptions& options) const = 0;
};

// Readers of the forms' keys, one per model. Issues are added to the list of the table.
[[nodiscard]] std::unique_ptr<ContactForm> read_surface_form(TableReader& table);
[[nodiscard]] std::unique_ptr<ContactForm> read_gradient_plane_form(TableReader& table);
[[nodiscard]] std::unique_ptr<ContactForm> read_voxmap_form(TableReader& table);

}  // namespace burrhole
