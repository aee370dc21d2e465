/// core/mesh/mesh_form.h: the contact model `mesh` as declared in a scene (contact_form.h).
#pragma once

#include "core/contact/contact_form.h"

namespace burrhole {

[[nodiscard]] std::unique_ptr<ContactForm> read_mesh_form(TableReader& table);

}  // namespace burrhole
