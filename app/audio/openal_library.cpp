#include "app/audio/openal_library.h"

#include <dlfcn.h>

namespace burrhole {
namespace {

template <class F>
bool find(void* library, const char* name, F& function) {
  function = reinterpret_cast<F>(dlsym(library, name));
  return function != nullptr;
}

}  // namespace

Result<OpenAl> load_openal() {
  void* const library = dlopen("libopenal.so.1", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return Error{ErrorCode::unavailable, "libopenal.so.1 (Debian: libopenal1) cannot be loaded", {}};
  OpenAl al;
  bool all = true;
#define BH_AL_FIND(name) all = find(library, "al" #name, al.name) && all;
#define BH_ALC_FIND(name) all = find(library, "alc" #name, al.c##name) && all;
  BH_AL_FUNCTIONS(BH_AL_FIND)
  BH_ALC_FUNCTIONS(BH_ALC_FIND)
#undef BH_AL_FIND
#undef BH_ALC_FIND
  if (!all) return Error{ErrorCode::unavailable, "libopenal.so.1 lacks a function of OpenAL 1.1", {}};
  return al;
}

}  // namespace burrhole
