/// app/audio/openal_library.h: the functions of OpenAL, found at run time, so that a program without sound loads no library.
///   Errors  unavailable: no library, or one that lacks a function.   Thread  any.
#pragma once

#include <AL/al.h>
#include <AL/alc.h>

#include "core/base/result.h"

#define BH_ALC_FUNCTIONS(F) \
  F(OpenDevice)             \
  F(CloseDevice)            \
  F(CreateContext)          \
  F(MakeContextCurrent)     \
  F(DestroyContext)         \
  F(GetString)

#define BH_AL_FUNCTIONS(F) \
  F(GenSources)            \
  F(DeleteSources)         \
  F(GenBuffers)            \
  F(DeleteBuffers)         \
  F(BufferData)            \
  F(SourceQueueBuffers)    \
  F(SourceUnqueueBuffers)  \
  F(GetSourcei)            \
  F(SourcePlay)            \
  F(SourceStop)            \
  F(GetError)

namespace burrhole {

struct OpenAl {
#define BH_AL_MEMBER(name) decltype(&al##name) name = nullptr;       // NOLINT(bugprone-macro-parentheses)
#define BH_ALC_MEMBER(name) decltype(&alc##name) c##name = nullptr;  // NOLINT(bugprone-macro-parentheses)
  BH_AL_FUNCTIONS(BH_AL_MEMBER)
  BH_ALC_FUNCTIONS(BH_ALC_MEMBER)
#undef BH_AL_MEMBER
#undef BH_ALC_MEMBER
};

/// Opens the library for the lifetime of the process.
[[nodiscard]] Result<OpenAl> load_openal();

}  // namespace burrhole
