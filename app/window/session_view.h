/// app/window/session_view.h: a recorded session in a window, with a time line: run, pause, step, speed, jump.
///   The session is replayed as it was recorded, so bone, tool and forces at the head are those of the run, bit for bit. A jump back
///   begins again and computes the steps up to there.
///   Threads  the caller's, which must be the main thread, polls events; replay and drawing have their own.
///   Errors   unavailable: no display, or no OpenGL 4.5 core; bad_input: the session cannot be replayed.
#pragma once

#include <string>

#include "app/session/session.h"
#include "app/window/window_loop.h"

namespace burrhole {

struct SessionView {
  std::string restore_path{};  ///< the checkpoint from which the run started; empty: bone as loaded
  MakeWindowSink make_sink;
  int width = 1280, height = 800;  ///< [pixels] of the window
  ViewerConfig viewer;
  const std::atomic<bool>* stop = nullptr;        ///< ends it, from a signal handler
  std::function<void(const std::string&)> say{};  ///< receives "window: ready" and the comparison at the end of the session
};

/// What came of the comparison with the run, if the session was shown to its end.
struct SessionViewed {
  bool compared = false;
  bool same = true;  ///< voxels, forces and forces sent to the hand
};

/// Opens the window, and returns when the person has closed it. @param loaded the session's scene, which must have [display].
[[nodiscard]] Result<SessionViewed> view_session(const SessionReader& session, const LoadedScene& loaded, const SessionView& view);

}  // namespace burrhole
