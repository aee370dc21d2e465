/// app/run/inputs.h: inputs of a user during a run. An input is applied between two servo ticks and recorded, so that a replay repeats it.
///   Units  SI.   Errors  bad_input.   Thread  files are read and checked before the run starts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/session/session.h"
#include "core/config/toml.h"

namespace burrhole {

enum class InputKind : std::uint8_t {
  spin,        ///< value: command of the drive, 0 off .. 1 the scene's spin
  switches,    ///< value: bits of pedals and buttons
  tool,        ///< text: a tool's name or path; data: the tool file's text
  undo,        ///< restores the bone before the last start of the spindle
  reset,       ///< restores the bone as loaded
  checkpoint,  ///< text: name under which the bone is stored
  restore,     ///< text: name of the checkpoint to restore
  pause,       ///< stops all clocks until a user resumes; without a user they start again at once
  mark,        ///< text: a remark
  export_bone  ///< text: format of a file of the bone as it is, by its ending
};
[[nodiscard]] const char* name_of(InputKind kind) noexcept;
/// @returns whether all clocks are stopped while it is applied.
[[nodiscard]] bool parks(InputKind kind) noexcept;

struct Input {
  std::uint64_t tick = 0;  ///< servo tick before which it is applied
  InputKind kind = InputKind::mark;
  double value = 0.0;  ///< [-] meaning as InputKind states
  std::string text, data;
};

/// @returns whether it leaves bone, tool and drive alone, so that it is also applied while the run is paused.
[[nodiscard]] constexpr bool is_query(InputKind kind) noexcept { return kind == InputKind::export_bone; }

/// @returns a recorded input. bad_input: an unknown kind, or a value out of range.
[[nodiscard]] Result<Input> input_from(const SessionInput& recorded);
[[nodiscard]] SessionInput to_record(const Input& input);

/// Timed inputs of a TOML file: [[input]] with time_s, kind, and value or name. Issues carry file:line:column. @param servo_hz [Hz].
/// @returns inputs in the order of time; nothing when any issue was pushed.
[[nodiscard]] std::optional<std::vector<Input>> read_inputs(const TomlDocument& document, int servo_hz, Issues& issues);

}  // namespace burrhole
