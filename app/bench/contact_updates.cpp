// Updates of the published window: words and leaps of a changed box, slides of the window, complete loads.
#include <fmt/format.h>

#include "app/bench/bench_scene.h"
#include "app/bench/contact_bones.h"
#include "core/base/random.h"
#include "core/voxel/box_parts.h"

namespace burrhole {
namespace {

/// Updates the words of a box of `edge` voxels after a random change; the baseline rebuilds all words.
void compare_update(Bench& bench, Voxmap& voxmap, int edge) {
  const VoxelBox window = voxmap.window().box;
  const Vec3i centre = (window.lo + window.hi) / 2;
  const VoxelBox box{centre - edge / 2, centre + edge / 2};
  const Vec3i size = window.size();
  const std::string name = fmt::format("words and leaps of a box of {}^3 over all of {} x {} x {}", edge, size.x, size.y, size.z);
  ContactWords kept, rebuilt;
  kept.rebuild(voxmap.window());
  std::uint64_t seed = 0;
  const auto change = [&] {
    ++seed;
    for_each_voxel(box, [&](const Vec3i& v) {
      const std::size_t at = window.offset_of(v);
      voxmap.remaining()[at] = static_cast<float>(uniform01(seed, at));
    });
    voxmap.commit(box);
  };
  const Side update{change, [&] { (void)kept.update(voxmap.window(), box.grown(1)); }};
  const Side rebuild{change, [&] { rebuilt.rebuild(voxmap.window()); }};
  update.prepare();
  update.run();
  rebuild.run();
  if (bench.agree(name, bytes_of(rebuilt.words()), bytes_of(kept.words())))
    bench.add_speed_up(name, "us", 1e6, bench.time(rebuild, update));
}

/// Compares two copies: all words and densities, or the valid records and all stiffnesses.
bool copies_agree(Bench& bench, const std::string& name, const ContactWindow& a, const ContactWindow& b) {
  if (!a.words.empty())
    return bench.agree(name, bytes_of(a.words), bytes_of(b.words)) && bench.agree(name, bytes_of(a.density), bytes_of(b.density));
  const auto valid_records = [](const ContactWindow& copy) {
    std::vector<Record16> out(copy.records_valid.count());
    copy_part(copy.records_valid, copy.box, std::get<std::vector<Record16>>(copy.records).data(), copy.records_valid, out.data());
    return out;
  };
  return bench.agree(name, bytes_of(valid_records(a)), bytes_of(valid_records(b))) &&
         bench.agree(name, bytes_of(a.stiffness), bytes_of(b.stiffness));
}

/// Slides the window by 8 voxels along an axis and back; the baseline loads it at each place.
Status compare_slide(Bench& bench, const std::shared_ptr<const BoneModel>& bone, const VoxelBox& here, std::size_t axis,
                     const ContactFields& fields) {
  Vec3i shift(0);
  shift[axis] = 8;
  const VoxelBox there{here.lo + shift, here.hi + shift}, away{here.lo + 200, here.hi + 200};
  const Vec3i size = here.size();
  const std::string name = fmt::format("slide a {} x {} x {} window by 8 voxels along {} over loading it, published with {}", size.x,
                                       size.y, size.z, "ijk"[axis], fields.words ? "words" : "records of 16 bits");
  auto sliding = Voxmap::create(bone, {}), loading = Voxmap::create(bone, {});
  if (!sliding || !loading) return sliding ? loading.error() : sliding.error();
  if (Status placed = sliding->place_window(here); !placed) return placed;
  if (Status placed = loading->place_window(here); !placed) return placed;
  ContactWindowPublisher slid(sliding.value(), fields), loaded(loading.value(), fields);
  const auto publish_all = [](ContactWindowPublisher& publisher, Voxmap& voxmap) {
    for (int n = 0; n < 3; ++n) {
      publisher.publish(voxmap);
      (void)publisher.exchange().latest();
    }
  };
  publish_all(slid, *sliding);
  publish_all(loaded, *loading);
  bool forth = false;
  const Side slide{[&] {
                     publish_all(slid, *sliding);
                     forth = !forth;
                   },
                   [&] {
                     (void)sliding->place_window(forth ? there : here);
                     slid.publish(*sliding);
                   }};
  const Side load{[&] {
                    (void)loading->place_window(away);
                    publish_all(loaded, *loading);
                  },
                  [&] {
                    (void)loading->place_window(there);
                    loaded.publish(*loading);
                  }};
  slide.prepare();
  slide.run();
  load.prepare();
  load.run();
  if (!copies_agree(bench, name, loaded.exchange().latest(), slid.exchange().latest())) return {};
  bench.add_speed_up(name, "us", 1e6, bench.time(load, slide));
  return {};
}

}  // namespace

Status bench_contact_updates(Bench& bench) {
  const auto loaded = load_parietal_scene({});
  if (!loaded) return loaded.error();
  const std::shared_ptr<const BoneModel>& bone = (*loaded)->bone;
  const VoxelBox bounds = bone->bounds();
  const Vec3i centre = (bounds.lo + bounds.hi) / 2;
  const VoxelBox here{centre - 48, centre + 48};
  auto voxmap = Voxmap::create(bone, {});
  if (!voxmap) return voxmap.error();
  if (Status placed = voxmap->place_window(here); !placed) return placed;
  for (const int edge : {20, 40}) compare_update(bench, voxmap.value(), edge);
  // The fields that the shipped models need: words for gradient-plane, records for surface.
  const ContactFields words{.gradient = false, .words = true}, records{.gradient = false, .records = RecordPrecision::bits16};
  for (const ContactFields& fields : {words, records})
    for (const std::size_t axis : {std::size_t{0}, std::size_t{2}})
      if (Status done = compare_slide(bench, bone, here, axis, fields); !done) return done;
  return {};
}

}  // namespace burrhole
