// The line that says what draws.
#include "app/view/driver_text.h"

#include <doctest/doctest.h>

using namespace burrhole;

TEST_CASE("driver: a person reads whether CPU or GPU draws; what is no driver stays as it is") {
  CHECK(driver_text("osmesa: 4.5 (Core Profile) Mesa 22.3.6, llvmpipe (LLVM 15.0.6, 256 bits)") ==
        "rendering on CPU: llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5 by osmesa");
  CHECK(driver_text("egl: 4.6.0 NVIDIA 535.1, NVIDIA H100/PCIe/SSE2") == "rendering on GPU: NVIDIA H100/PCIe/SSE2, OpenGL 4.6.0 by egl");
  CHECK(driver_text("none") == "none");
  CHECK(driver_text("") == "");
}
