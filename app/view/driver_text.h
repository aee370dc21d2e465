/// app/view/driver_text.h: what draws the pictures, in a line for a person.
///   Errors  none.   Thread  any.
#pragma once

#include <string>
#include <string_view>

namespace burrhole {

/// @param driver "BACKEND: VERSION, RENDERER", as Renderer::driver(). @returns "rendering on CPU: RENDERER, OpenGL 4.5 by BACKEND", or on
/// GPU; another text as it is.
[[nodiscard]] std::string driver_text(std::string_view driver);

}  // namespace burrhole
