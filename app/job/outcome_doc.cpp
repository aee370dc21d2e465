#include "app/job/outcome_doc.h"

#include <fmt/format.h>

#include "app/job/expectation.h"

namespace burrhole {
namespace {

constexpr const char* kHead = R"(# The outcome of a run

Each run has one **result**, with its **reason**, and **flags**. `summary.json`, the report, and the last line of `burrhole drill` on stderr (not
with `--quiet`) show them. A replay has the figures of bone and tool of its run; how a run ended, and steps that a live run missed, belong to the run alone.

`burrhole docs outcome` generates this page from the tables that judge runs.

## Definitions
- **Cross-section** of a bit: the projection of its cutting part along the axis, from the tip up to the first shoulder: a disc for a drill or a burr,
  a ring for a crown, a rectangle for a saw blade; of a 14/11 perforator the inner drill alone. A shoulder is where the cutting part widens by more
  than 0.25 mm after it has not widened over 0.5 mm.
- **Column**: the bone as loaded that lies in the direction of the axis over one cell of the cross-section, round the planned axis. It is *clear* if
  none of that bone is left at the end of the run.
- **Cleared share**: the share of the columns that are clear. It decides whether the bone is drilled through.
- **Breakthrough**: the time at which no bone is left on the axis itself. A bit with a point or a shoulder then still cuts at full thrust. The
  picture and the event of this name use it; a crown has none, because its core stays on the axis, and a narrow hole has one although the bit is
  not through.
- **Steady thrust**: the mean of the thrust that bone carries along the axis while it carries more than 1 N, exponentially weighted over 0.5 s.
- **Loss of support**: it begins at the last time at which bone carried at least half of the steady thrust and more than 1 N, once the tip is
  beyond the last bone on the axis. It ends when bone has carried as much again for 0.1 s without a break, so that a bounce does not end it. Half is
  the mid-reference level, at which the instant of a transition between two states is taken (IEEE Std 181); the times are our own.
- **Uncut share**: of the columns that the bit has passed by more than 0.5 mm and a voxel, the share that is not clear; absent
  if it has passed less than half of them.
- **Plunge**: the advance without support: the largest distance of the tip beyond its depth where a loss of support began, before that loss ends.
  A bit that leaves the bone cutting at full thrust has a plunge of 0. Of a bit that was pushed through uncut bone, and above a hole that was open
  at the start, it is the distance beyond the bone.
- **Beyond**: the largest depth of the tip beyond the bone on the axis, cut or fallen. Published plunge depths of bicortical drilling are this distance
  (Clement et al. 2012, Ding and Marmor 2019), so compare them with it.

These come in this order: no bone is left on the axis ahead of the tip (`passed_s`), the axis is clear (`breakthrough_s`), support is lost
(`support_lost_s`), and the tip is deepest. The result and the flag `plunged` do not depend on the second. Bone within the engaged depth is cut
ahead of the tip, so the tip itself is beyond the bone as loaded later than `passed_s`, at `tip_out_s`.

## Results
The first criterion that holds is the result. Results that nothing later takes back come first; an interruption comes before those that a longer
run could have changed.

| | result | criterion |
|---|---|---|
)";

constexpr const char* kFlagHead = R"(
## Flags
Flags do not depend on each other.

| flag | criterion |
|---|---|
)";

constexpr const char* kExpectHead = R"(
## Expectations
`burrhole drill --expect TERMS` exits with code 3 and prints one line for each term that does not hold. An error in TERMS is exit code 2, before
the run. Ctrl-C is exit code 130 whatever was expected. Terms are separated by commas, and all must hold:

- a result, or `through` for `drilled-through`;
- `no FLAG`: the flag is not set;
- `FIGURE<VALUE UNIT` or `FIGURE>VALUE UNIT`, as in `plunge<0.5mm`. A figure that the run does not have does not hold;
- the same with the figure's key of summary.json, as in `plunge_mm<0.5` or `drilling.plunge_mm<0.5`. The unit is in such a name and may be left out.

| figure | unit | key of summary.json |
|---|---|---|
)";

}  // namespace

std::string outcome_markdown() {
  std::string out = kHead;
  int order = 0;
  for (const OutcomeRow& row : result_rows({})) out += fmt::format("| {} | `{}` | {} |\n", ++order, row.name, row.criterion);
  out += kFlagHead;
  for (const OutcomeRow& row : flag_rows({})) out += fmt::format("| `{}` | {} |\n", row.name, row.criterion);
  out += kExpectHead;
  for (const ExpectedFigure& figure : expected_figures())
    out += fmt::format("| `{}` | {} | `{}` |\n", figure.name, figure.unit, figure.about);
  return out;
}

}  // namespace burrhole
